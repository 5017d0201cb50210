#version 450 core
// Gaps of a peeled layer through which lens rays may pass behind it: the greatest inverse depth at which they do, for each 2x2 pixels.
// in:  w of the layer (1/m; 0 empty, negative partly transparent) and its slopes; the reach behind the layers before (1/m), if any
// out: w of the nearest surface beside a gap in the block, 1/m; NOWHERE without a gap. Rays may come from beyond an open side, behind
//      the surfaces along it.
// The argument is in render/layers/reach.py.

layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) writeonly uniform image2D gaps;

uniform sampler2D w;
uniform usampler2D slopes;
uniform int channel;
uniform float umbra;  // 1/m
uniform ivec4 open_sides;   // 1 where more layers lie beyond the left, upper, right and lower side
#ifdef BEHIND_OTHERS
uniform sampler2D reach_before;
#endif

#include "trace/slopes.glsl"

const float LEAST_GAP = 0.05;   // share of the umbra by which surfaces of neighbouring pixels may differ at their border: the march's OVERLAP
const int SIDE = 3;             // the block, and the pixels to its right and below

// A pixel's surface: its w and the change of w by a pixel, the greatest w that a ray behind it may have, and whether it lets rays pass.
struct Patch { float w; vec2 slope; float top; float steepness; bool clear; };

Patch patch_at(ivec2 pixel)
{
    pixel = min(pixel, textureSize(w, 0) - 1);
    float stored = texelFetch(w, pixel, 0)[channel], here = abs(stored);
    if (stored == 0.0) return Patch(0.0, vec2(0.0), 0.0, 0.0, false);
    uvec4 bits = uvec4(texelFetch(slopes, pixel, 0)[channel]);
    vec2 slope = here * vec2(unpacked_slopes(bits).x, unpacked_slopes(bits >> 8).x);
    float change = abs(slope.x) + abs(slope.y), most = 2.0 * LONGEST_REACH * here;
    float top = here + min(change, most);
#ifdef BEHIND_OTHERS
    top = min(top, texelFetch(reach_before, pixel / REACH_BLOCK, 0).x);
#endif
    return Patch(here, slope, top, change > most ? 1.0 : change / umbra, stored < 0.0);
}

// The greatest w at which a ray may pass between the surfaces of two neighbouring pixels, from in front of one to behind the other.
float gap_between(Patch from, Patch to, vec2 way)
{
    vec2 bend = from.slope - to.slope;
    float apart = abs(from.w - to.w + 0.5 * dot(from.slope + to.slope, way)) + 0.5 * abs(dot(bend, vec2(way.y, -way.x)));
    float steepness = max(from.steepness, to.steepness);
    bool joined = steepness < 1.0 && apart <= LEAST_GAP * umbra * (1.0 - steepness);
    return joined ? NOWHERE : max(from.top, to.top);
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, imageSize(gaps)))) return;
    Patch patches[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; ++i) patches[i] = patch_at(2 * block + ivec2(i % SIDE, i / SIDE));
    float most = NOWHERE;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            int i = SIDE * y + x;
            ivec2 pixel = 2 * block + ivec2(x, y), beyond = max(textureSize(w, 0) - 1 - pixel, ivec2(0));
            bool at_open_side = any(lessThan(ivec4(pixel, beyond), open_sides));
            if (patches[i].clear || at_open_side) most = max(most, patches[i].top);
            most = max(most, gap_between(patches[i], patches[i + 1], vec2(1.0, 0.0)));
            most = max(most, gap_between(patches[i], patches[i + SIDE], vec2(0.0, 1.0)));
            most = max(most, gap_between(patches[i], patches[i + SIDE + 1], vec2(1.0, 1.0)));
            most = max(most, gap_between(patches[i + 1], patches[i + SIDE], vec2(-1.0, 1.0)));
        }
    imageStore(gaps, block, vec4(most));
}
