#version 450 core
// Takes note that the picked pixels are spread as they are.
// in:  `picked`; light and state as they are
// out: `light_last`, `state_last`: those of the sums; `state_before`: what `state_last` was, in tiles of which any is picked; `waiting`:
//      0 for the picked; `lit`, `reaches`: as linear_reach.comp has them, of the same tiles

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D light_last;
layout(rg32f, binding = 1) uniform image2D state_last;
layout(rg32f, binding = 2) uniform writeonly image2D state_before;
layout(r32ui, binding = 3) uniform writeonly uimage2D waiting;
layout(std430, binding = 1) readonly buffer Picked { uvec2 picked[]; };
layout(std430, binding = 2) writeonly buffer Lit { uvec2 lit[]; };
layout(std430, binding = 3) writeonly buffer Reaches { float reaches[]; };

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform sampler2D table_reaches;
uniform ivec2 tiles;

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy), size = imageSize(light_last);
    if (any(greaterThanEqual(tile, tiles))) return;
    int number = tile.y * tiles.x + tile.x;
    uvec2 bits = picked[number], shedding = uvec2(0u);
    float reach = -1.0;
    int count = bits == uvec2(0u) ? 0 : 64;
    for (int i = 0; i < count; ++i) {
        ivec2 at = tile * 8 + ivec2(i & 7, i >> 3);
        if (any(greaterThanEqual(at, size))) continue;
        bool is_picked = (((i < 32 ? bits.x : bits.y) >> (i & 31)) & 1u) != 0u;
        vec4 state = imageLoad(state_last, at), light = imageLoad(light_last, at);
        imageStore(state_before, at, state);
        if (is_picked) {
            state = texelFetch(state_now, at, 0);
            light = texelFetch(light_now, at, 0);
            imageStore(light_last, at, light);
            imageStore(state_last, at, state);
            imageStore(waiting, at, uvec4(0u));
        }
        if (light != vec4(0.0)) {
            if (i < 32) shedding.x |= 1u << i; else shedding.y |= 1u << (i - 32);
            reach = max(reach, texelFetch(table_reaches, ivec2(int(state.x), 0), 0).r);
        }
    }
    if (count > 0) {
        lit[number] = shedding;
        reaches[number] = reach;
    }
}
