#version 450 core
// Record the light and state of spread pixels as those of the sums.
// in:  `emitters`: changed pixels (linear_load.comp); PICKED: those that are spread now; current light and state
// out: `light_last`, `state_last`: those of the sums; CUTOFF: `state_before`: the previous `state_last`, in tiles with spread pixels;
//      WAITING: `waiting`: 0 for spread pixels; `lit`, `lit_reaches`, `tile_bits`: as in linear/linear_load.comp, of the same tiles

layout(local_size_x = 64) in;
layout(rgba32f, binding = 0) uniform image2D light_last;
layout(rg32f, binding = 1) uniform image2D state_last;
#ifdef CUTOFF
layout(rg32f, binding = 2) uniform writeonly image2D state_before;
#endif
#ifdef WAITING
layout(r32ui, binding = 3) uniform writeonly uimage2D waiting;
#endif
layout(std430, binding = 1) readonly buffer Emitters { uvec4 emitters[]; };
layout(std430, binding = 2) writeonly buffer Lit { uvec4 lit[]; };
layout(std430, binding = 3) writeonly buffer LitReaches { float lit_reaches[]; };
layout(std430, binding = 4) buffer TileBits { uint tile_bits[]; };
#ifdef PICKED
layout(std430, binding = 5) readonly buffer Picked { uint picked[]; };
#endif

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform ivec2 tiles;
uniform int tile_bit_words;

#include "linear/linear_reach.glsl"

void main()
{
    int lane = int(gl_GlobalInvocationID.x);
    ivec2 tile = ivec2((lane >> 1) % tiles.x, (lane >> 1) / tiles.x), size = imageSize(light_last);
    if (tile.y >= tiles.y) return;
    uint bits = emitters[lane].x, beside = emitters[lane ^ 1].x;
#ifdef PICKED
    bits &= picked[lane];
    beside &= picked[lane ^ 1];
#endif
    uvec2 emits = uvec2(0u);
    float reach = -1.0;
    int count = (bits | beside) == 0u ? 0 : 32;
    for (int i = 0; i < count; ++i) {
        ivec2 at = tile * 8 + ivec2(i & 7, (lane & 1) * 4 + (i >> 3));
        if (any(greaterThanEqual(at, size))) continue;
        vec4 state = imageLoad(state_last, at), light = imageLoad(light_last, at);
#ifdef CUTOFF
        imageStore(state_before, at, state);
#endif
        if (((bits >> i) & 1u) != 0u) {
            state = texelFetch(state_now, at, 0);
            light = texelFetch(light_now, at, 0);
            imageStore(light_last, at, light);
            imageStore(state_last, at, state);
#ifdef WAITING
            imageStore(waiting, at, uvec4(0u));
#endif
        }
        if (light != vec4(0.0)) {
            emits |= uvec2(1u << i, state.x > 0.0 ? 1u << i : 0u);
            reach = max(reach, reach_of(light, state.xy));
        }
    }
    if (count > 0) {
        lit[lane] = uvec4(emits.x, 0u, emits.y, 0u);
        lit_reaches[lane] = reach;
        if (emits.x != 0u) atomicOr(tile_bits[tile.y * tile_bit_words + (tile.x >> 5)], 1u << (tile.x & 31));
    }
}
