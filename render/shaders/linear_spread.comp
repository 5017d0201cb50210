#version 450 core
// Spreads light over circles of confusion: each pixel of a tile gathers, from the pixels around it that shed any, what reaches it.
// in:  light and state of all pixels (linear_take.comp), which of them shed and how far (linear_reach.comp); the tables
// out: `shown`: the sum of weighted light, and the sum of weights. DIFFERENCE: both are of what was before, and what has changed is
//      added to them: the new effect of each pixel less its old one (Fearing 1995, section 4.1), on the tiles that are listed. REJUDGE:
//      what is added is what the listed tiles' own pixels hide no more, less what they hide now
// Potmesil & Chakravarty 1981. `sums` are the same with all their bits, where they are kept.

layout(local_size_x = 8, local_size_y = 8 / ROWS) in;
layout(rgba32f, binding = 0) uniform writeonly image2D shown;
layout(std430, binding = 1) readonly buffer Masks { uvec2 masks[]; };
layout(std430, binding = 2) readonly buffer Reaches { float reaches[]; };
#ifdef KEEP
layout(std430, binding = 0) buffer Sums { dvec4 sums[]; };
#endif
#ifdef LISTED
layout(std430, binding = 3) readonly buffer Listed { uint listed_count; uint listed[]; };
#endif
#ifdef DIFFERENCE
uniform sampler2D light_last;
uniform sampler2D state_last;
#endif

#ifdef REJUDGE
uniform sampler2D state_before;
#endif

#include "linear_spread.glsl"

uniform sampler2D light_now;
uniform sampler2D state_now;
uniform ivec2 tiles;
uniform int tiles_around;           // that anything reaches
uniform int first_tile;             // row of tiles that this is the first of

// Pixels of a tile that reach another one, as bits.
uvec2 reaching(ivec2 from, ivec2 to)
{
    int number = from.y * tiles.x + from.x;
    vec2 gap = vec2(max(abs(from - to) * 8 - 7, 0));
    return length(gap) <= reaches[number] ? masks[number] : uvec2(0u);
}

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
#ifdef REJUDGE
        before_px[row] = texelFetch(state_before, min(own + ivec2(0, row), size - 1), 0).y;
#endif
    }
    ivec2 low = max(tile - tiles_around, ivec2(0)), high = min(tile + tiles_around, tiles - 1);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) {
            uvec2 bits = reaching(ivec2(x, y), tile);
            int count = bitCount(bits.x) + bitCount(bits.y);
            for (int i = 0; i < count; ++i) {
                bool is_upper = bits.x != 0u;
                int bit = is_upper ? findLSB(bits.x) : 32 + findLSB(bits.y);
                bits = is_upper ? uvec2(bits.x & (bits.x - 1u), bits.y) : uvec2(0u, bits.y & (bits.y - 1u));
                ivec2 at = ivec2(x, y) * 8 + ivec2(bit & 7, bit >> 3);
                shed(texelFetch(light_now, at, 0), texelFetch(state_now, at, 0).xy, own - at);
#ifdef DIFFERENCE
                shed(-texelFetch(light_last, at, 0), texelFetch(state_last, at, 0).xy, own - at);
#endif
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
        imageStore(shown, at, vec4(total[row]));
    }
}
