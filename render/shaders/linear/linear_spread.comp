#version 450 core
// Spread light over circles of confusion: each pixel of a tile gathers the light that reaches it from the pixels around it.
// in:  light and state of all pixels, the emitters among them and their reach (linear_load.comp); the tables
// out: `result`: the sum of weighted light, and the sum of weights; `sums`: the exact sums, with KEEP.
//      LISTED: changes are added to the sums of the listed tiles. DIFFERENCE: a change is the new effect of a pixel less its old
//      one (Fearing 1995, section 4.1). RECHECK: a change is the light that a pixel no longer hides, less the light it now hides
// Potmesil & Chakravarty 1981.

layout(local_size_x = 8, local_size_y = 8 / ROWS) in;
layout(rgba32f, binding = 0) uniform writeonly image2D result;
layout(std430, binding = 1) readonly buffer Emitters { uvec4 emitters[]; };
layout(std430, binding = 2) readonly buffer Reaches { float reaches[]; };
layout(std430, binding = 4) readonly buffer TileBits { uint tile_bits[]; };
#ifdef KEEP
layout(std430, binding = 0) buffer Sums { dvec4 sums[]; };
#endif
#ifdef LISTED
layout(std430, binding = 3) readonly buffer Listed { uint listed_count; uint listed[]; };
#endif
#ifdef PICKED
layout(std430, binding = 5) readonly buffer Picked { uint picked[]; };
#endif
#ifdef DIFFERENCE
uniform sampler2D light_last;
uniform sampler2D state_last;
uniform int first_difference;       // number of the first table of differences
#include "importance/importance_change.glsl"
#endif
#ifdef RECHECK
uniform sampler2D state_before;
#endif

#include "linear/linear_spread.glsl"

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform ivec2 tiles;
uniform int tile_bit_words;         // words of 32 bits for each row of tiles
uniform int tiles_around;           // tiles within the greatest reach
uniform int first_tile;             // first row of tiles of this dispatch

// Effects of a tile's pixels that reach another tile: bits of the two halves for new effects, then for old ones.
uvec4 reaching(ivec2 from, ivec2 to)
{
    int number = 2 * (from.y * tiles.x + from.x);
    vec2 gap = vec2(max(abs(from - to) * 8 - 7, 0));
    bool reach = length(gap) <= max(reaches[number], reaches[number + 1]);
    uvec4 upper = emitters[number], lower = emitters[number + 1];
    uvec4 bits = from == to ? uvec4(upper.x, lower.x, upper.y, lower.y) : uvec4(upper.z, lower.z, upper.w, lower.w);
#ifdef PICKED
    bits &= uvec2(picked[number], picked[number + 1]).xyxy;
#endif
    return reach ? bits : uvec4(0u);
}

// Bits of the tiles with light among fewer than 32 tiles of a row, from the first one on.
uint tile_bits_around(int first, int last, int y)
{
    int word = y * tile_bit_words + (first >> 5), shift = first & 31;
    uint bits = tile_bits[word] >> shift | (shift > 0 ? tile_bits[word + 1] << (32 - shift) : 0u);
    return bits & ((1u << (last - first + 1)) - 1u);
}

// Remove the lowest set bit and return its pixel in the tile; from 64 on it is an old effect.
int next(inout uvec4 bits)
{
    int word = bits.x != 0u ? 0 : bits.y != 0u ? 1 : bits.z != 0u ? 2 : 3;
    uint from = bits.x != 0u ? bits.x : bits.y != 0u ? bits.y : bits.z != 0u ? bits.z : bits.w;
    bits &= uvec4(word == 0 ? from - 1u : ~0u, word == 1 ? from - 1u : ~0u, word == 2 ? from - 1u : ~0u, word == 3 ? from - 1u : ~0u);
    return 32 * word + findLSB(from);
}

#ifdef DIFFERENCE
void spread_change(ivec2 at, bool is_old, ivec2 offset)
{
    vec4 light = texelFetch(light_now, at, 0), before = texelFetch(light_last, at, 0);
    vec2 state = texelFetch(state_now, at, 0).xy, state_then = texelFetch(state_last, at, 0).xy;
    bool step = is_step(light, state, before, state_then), is_taken = state == state_then;
    dvec4 effect = is_old ? -dvec4(before) : step ? dvec4(state.x > state_then.x ? light : -light)
                                                  : dvec4(light) - dvec4(is_taken ? before : vec4(0.0));
    int table = is_old ? int(state_then.x) : step ? first_difference + int(min(state.x, state_then.x)) : int(state.x);
    spread_light(effect, table, is_old ? state_then.y : state.y, offset);
}
#endif

void main()
{
#ifdef LISTED
    uint turn = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (turn >= listed_count) return;
    ivec2 tile = ivec2(int(listed[turn]) % tiles.x, int(listed[turn]) / tiles.x);
#else
    ivec2 tile = ivec2(gl_WorkGroupID.xy) + ivec2(0, first_tile);
#endif
    ivec2 size = textureSize(light_now, 0);
    ivec2 own = tile * 8 + ivec2(gl_LocalInvocationID.xy) * ivec2(1, ROWS);
    for (int row = 0; row < ROWS; ++row) {
        total[row] = dvec4(0.0);
#ifdef DIFFERENCE
        own_px[row] = texelFetch(state_last, min(own + ivec2(0, row), size - 1), 0).y;
#else
        own_px[row] = texelFetch(state_now, min(own + ivec2(0, row), size - 1), 0).y;
#endif
#ifdef RECHECK
        before_px[row] = texelFetch(state_before, min(own + ivec2(0, row), size - 1), 0).y;
#endif
    }
    ivec2 low = max(tile - tiles_around, ivec2(0)), high = min(tile + tiles_around, tiles - 1);
    for (int y = low.y; y <= high.y; ++y) {
        uint around = tile_bits_around(low.x, high.x, y);
        int tile_count = bitCount(around);
        for (int i_tile = 0; i_tile < tile_count; ++i_tile) {
            int x = low.x + findLSB(around);
            around &= around - 1u;
            uvec4 bits = reaching(ivec2(x, y), tile);
            int count = bitCount(bits.x) + bitCount(bits.y) + bitCount(bits.z) + bitCount(bits.w);
            for (int i = 0; i < count; ++i) {
                int bit = next(bits);
                ivec2 at = ivec2(x, y) * 8 + ivec2(bit & 7, (bit & 63) >> 3);
#ifdef DIFFERENCE
                spread_change(at, bit >= 64, own - at);
#else
                vec2 state = texelFetch(state_now, at, 0).xy;
                spread_light(dvec4(texelFetch(light_now, at, 0)), int(state.x), state.y, own - at);
#endif
            }
        }
    }
    for (int row = 0; row < ROWS; ++row) {
        ivec2 at = own + ivec2(0, row);
        if (any(greaterThanEqual(at, size))) continue;
#ifdef KEEP
        int number = at.y * size.x + at.x;
#ifdef LISTED
        total[row] += sums[number];
#endif
        sums[number] = total[row];
#endif
        imageStore(result, at, vec4(total[row]));
    }
}
