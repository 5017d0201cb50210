#version 450 core
// How far the picked pixels of each tile shed light, before and now, and which tiles that reaches.
// in:  `masks` of the picked; light and state as they are, and as they are in the sums
// out: `reaches` in pixels, below 0 where none is picked; `reached`: 1 for each tile that any light reaches; `judged`: 1 for each tile
//      of which a pixel's own state changes

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 1) readonly buffer Masks { uvec2 masks[]; };
layout(std430, binding = 2) writeonly buffer Reaches { float reaches[]; };
layout(std430, binding = 3) writeonly buffer Reached { uint reached[]; };
layout(std430, binding = 4) writeonly buffer Judged { uint judged[]; };

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform sampler2D light_last;
uniform sampler2D state_last;
uniform sampler2D table_reaches;
uniform ivec2 tiles;

float reach_of(vec4 light, float state)
{
    return light == vec4(0.0) ? -1.0 : texelFetch(table_reaches, ivec2(int(state), 0), 0).r;
}

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, tiles))) return;
    int number = tile.y * tiles.x + tile.x;
    uvec2 bits = masks[number];
    int count = bitCount(bits.x) + bitCount(bits.y);
    float reach = -1.0;
    bool is_judged = false;
    for (int i = 0; i < count; ++i) {
        bool is_upper = bits.x != 0u;
        int bit = is_upper ? findLSB(bits.x) : 32 + findLSB(bits.y);
        bits = is_upper ? uvec2(bits.x & (bits.x - 1u), bits.y) : uvec2(0u, bits.y & (bits.y - 1u));
        ivec2 at = tile * 8 + ivec2(bit & 7, bit >> 3);
        vec2 now = texelFetch(state_now, at, 0).xy, last = texelFetch(state_last, at, 0).xy;
        reach = max(reach, max(reach_of(texelFetch(light_now, at, 0), now.x), reach_of(texelFetch(light_last, at, 0), last.x)));
        if (now.y != last.y) is_judged = true;
    }
    reaches[number] = reach;
    if (is_judged) judged[number] = 1u;
    int around = reach < 0.0 ? -1 : (int(reach) + 7) / 8;
    ivec2 low = max(tile - around, ivec2(0)), high = min(tile + around, tiles - 1);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
            if (length(vec2(max(abs(ivec2(x, y) - tile) * 8 - 7, 0))) <= reach) reached[y * tiles.x + x] = 1u;
}
