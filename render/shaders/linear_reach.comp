#version 450 core
// Which pixels of each tile shed light, and how far.
// in:  light and state of all pixels (linear_take.comp)
// out: `masks`: a bit for each pixel of a tile, rows of eight; `reaches` in pixels, below 0 where none sheds any

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 1) writeonly buffer Masks { uvec2 masks[]; };
layout(std430, binding = 2) writeonly buffer Reaches { float reaches[]; };

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform sampler2D table_reaches;
uniform ivec2 tiles;

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy), size = textureSize(light_now, 0);
    if (any(greaterThanEqual(tile, tiles))) return;
    uint bits[2] = uint[2](0u, 0u);
    float reach = -1.0;
    for (int half_tile = 0; half_tile < 2; ++half_tile)
        for (int i = 0; i < 32; ++i) {
            ivec2 at = tile * 8 + ivec2(i & 7, half_tile * 4 + (i >> 3));
            bool sheds = all(lessThan(at, size)) && texelFetch(light_now, at, 0) != vec4(0.0);
            if (!sheds) continue;
            bits[half_tile] |= 1u << i;
            reach = max(reach, texelFetch(table_reaches, ivec2(int(texelFetch(state_now, at, 0).x), 0), 0).r);
        }
    int number = tile.y * tiles.x + tile.x;
    masks[number] = uvec2(bits[0], bits[1]);
    reaches[number] = reach;
}
