#version 450 core
// Load a field for spreading: its light rounded to whole steps, and the table of each pixel. An invocation loads half a tile
// of 8 by 8 pixels.
// in:  light (premultiplied), radii in pixels. COMPARE: light and state as they are in the sums
// out: `light_now`; `state_now`: number of the table, signed radius in pixels (positive in front of the focus); COMPARE: only of
//      changed pixels; `emitters`: for each half tile the bits of the pixels with light, COMPARE: of changed pixels (x), of those
//      whose old effect must be subtracted (y), and of both those that spread beyond themselves (z, w); `reaches`: greatest reach
//      in pixels; `tile_bits`: a bit for each tile with emitters; `brightest` light; number of pixels `changed`.
//      ORDERED: `waiting` and `counts` (importance_sort.comp)
// Circle-of-confusion pass of Potmesil & Chakravarty 1981, at the steps of Fearing 1995, section 4.2.

layout(local_size_x = 64) in;
layout(rgba32f, binding = 0) uniform writeonly image2D light_now;
layout(rg32f, binding = 1) uniform writeonly image2D state_now;
layout(std430, binding = 1) writeonly buffer Emitters { uvec4 emitters[]; };
layout(std430, binding = 2) writeonly buffer Reaches { float reaches[]; };
layout(std430, binding = 3) buffer Summary { uint brightest; uint changed; };
layout(std430, binding = 4) buffer TileBits { uint tile_bits[]; };

uniform sampler2D light;
uniform sampler2D radii;
uniform int channel;                // of the radii
uniform float side;                 // 1 in front of the focus, -1 behind it; where the radii are signed, 1
uniform float step_px;
uniform float most_even;
uniform sampler2D steps;            // for even steps of the radius: number of the table, and its radius
uniform float quantum;              // step of light: a power of 2
uniform float quantum_alpha;
uniform ivec2 tiles;
uniform int tile_bit_words;         // words of 32 bits for each row of tiles

#include "linear/linear_reach.glsl"
#ifdef COMPARE
uniform sampler2D light_last;
uniform sampler2D state_last;
#include "importance/importance_change.glsl"
#endif
#ifdef ORDERED
#include "importance/importance_bucket.glsl"
#endif

vec4 light_at(ivec2 at)
{
    vec4 from = texelFetch(light, at, 0);
    return mix(clamp(from, -1e12, 1e12), vec4(0.0), isnan(from));   // a NaN would stay in every sum for ever
}

vec2 state_of(ivec2 at)
{
    float radius = texelFetch(radii, at, 0)[channel];
    vec2 nearest = texelFetch(steps, ivec2(int(min(abs(radius) / step_px + 0.5, most_even)), 0), 0).rg;
    return vec2(nearest.x, sign(radius) * side * nearest.y);
}

void main()
{
    int lane = int(gl_GlobalInvocationID.x);
    ivec2 tile = ivec2((lane >> 1) % tiles.x, (lane >> 1) / tiles.x), size = imageSize(light_now);
    bool is_inside = tile.y < tiles.y;
    uvec4 emits = uvec4(0u);
    vec4 grid = vec4(vec3(quantum), quantum_alpha);
    float reach = -1.0, peak = 0.0;
#ifdef ORDERED
    begin_counting();
#endif
    for (int i = 0; i < 32; ++i) {
        ivec2 at = tile * 8 + ivec2(i & 7, (lane & 1) * 4 + (i >> 3));
        if (!is_inside || any(greaterThanEqual(at, size))) continue;
        vec4 from = light_at(at), now = roundEven(from / grid) * grid;
        peak = max(peak, max(abs(from.r), max(abs(from.g), abs(from.b))));
        vec2 state = state_of(at);
        uint bit = 1u << i;
#ifdef COMPARE
        vec4 last = texelFetch(light_last, at, 0);
        vec2 state_before = texelFetch(state_last, at, 0).xy;
        bool has_changed = now != last || state != state_before;
        if (has_changed) {
            imageStore(light_now, at, now);
            imageStore(state_now, at, vec4(state, 0.0, 0.0));
        }
        bool twofold = has_changed && is_twofold(now, state, last, state_before);
        bool step = has_changed && is_step(now, state, last, state_before);
        emits |= uvec4(has_changed ? bit : 0u, twofold ? bit : 0u,
                       has_changed && (state.x > 0.0 || step) ? bit : 0u, twofold && state_before.x > 0.0 ? bit : 0u);
        reach = has_changed ? max(reach, max(reach_of(now, state), reach_of(last, state_before))) : reach;
#ifdef ORDERED
        count_change(at, has_changed, now, state, last, state_before);
#endif
#else
        imageStore(light_now, at, now);
        imageStore(state_now, at, vec4(state, 0.0, 0.0));
        bool has_light = now != vec4(0.0);
        emits |= uvec4(has_light ? bit : 0u, 0u, has_light && state.x > 0.0 ? bit : 0u, 0u);
        reach = max(reach, reach_of(now, state));
#endif
    }
    if (is_inside) {
        emitters[lane] = emits;
        reaches[lane] = reach;
        atomicMax(brightest, floatBitsToUint(peak));
        if (emits.x != 0u) atomicOr(tile_bits[tile.y * tile_bit_words + (tile.x >> 5)], 1u << (tile.x & 31));
#ifdef COMPARE
        if (emits.x != 0u) atomicAdd(changed, uint(bitCount(emits.x)));
#endif
    }
#ifdef ORDERED
    end_counting();
#endif
}
