#version 450 core
// Range of inverse depth of each 4x4 block over all layers.
// in:  w of the layers, four in a texture (1/m; 0 empty, negative partly transparent), and its slopes
// out: (min, max) of |w| between the corners of the block's pixels in slice 0, empty ones left out: (+big, 0) where all are empty
// Lee, Eisemann & Seidel 2010, section 3.1, "Multi-Layer Packing"; Decoret 2005.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) writeonly uniform image2DArray ranges;

uniform sampler2D near_w;  // layers 0 to 3
uniform sampler2D far_w;   // layers 4 to 7, if any
uniform usampler2D near_slopes;
uniform usampler2D far_slopes;
uniform bool two_packs;

#include "trace/slopes.glsl"

#ifdef MOVERS
layout(std430, binding = 1) readonly buffer Swept { uvec2 swept[]; };  // range of w of the movers through each block (movers.comp)
#endif

// Extend `range` by the w of four layers.
vec2 joined(vec2 range, vec4 stored, uvec4 slopes)
{
    vec4 w = abs(stored), reach = w * reach_of(slopes);
    vec4 low = mix(w - reach, vec4(EMPTY_MIN), equal(w, vec4(0.0)));
    vec4 high = w + reach;
    return vec2(min(range.x, min(min(low.x, low.y), min(low.z, low.w))),
                max(range.y, max(max(high.x, high.y), max(high.z, high.w))));
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = textureSize(near_w, 0);
    if (any(greaterThanEqual(block, imageSize(ranges).xy))) return;
    vec2 range = vec2(EMPTY_MIN, 0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, size))) continue;
        range = joined(range, texelFetch(near_w, pixel, 0), texelFetch(near_slopes, pixel, 0));
        if (two_packs) range = joined(range, texelFetch(far_w, pixel, 0), texelFetch(far_slopes, pixel, 0));
    }
#ifdef MOVERS
    vec2 through = uintBitsToFloat(swept[block.y * imageSize(ranges).x + block.x]);
    if (through.y > 0.0) range = vec2(min(range.x, through.x), max(range.y, through.y));
#endif
    imageStore(ranges, ivec3(block, 0), vec4(range, 0.0, 0.0));
}
