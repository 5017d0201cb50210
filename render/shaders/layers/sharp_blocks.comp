#version 450 core
// Range of inverse depth of each 4x4 block of the sharp layer.
// in:  its w (1/m; 0 or less empty) and slopes
// out: (min, max) of w between the corners of the block's texels in slice 0, empty ones left out: (+big, 0) where all are empty

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) writeonly uniform image2DArray ranges;

uniform sampler2D sharp_w;
uniform usampler2D sharp_slopes;

#include "trace/slopes.glsl"

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy), size = textureSize(sharp_w, 0);
    if (any(greaterThanEqual(block, imageSize(ranges).xy))) return;
    vec2 range = vec2(EMPTY_MIN, 0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, size))) continue;
        float w = texelFetch(sharp_w, pixel, 0).r;
        if (w <= 0.0) continue;
        float reach = w * reach_of(texelFetch(sharp_slopes, pixel, 0).rrrr).x;
        range = vec2(min(range.x, w - reach), max(range.y, w + reach));
    }
    imageStore(ranges, ivec3(block, 0), vec4(range, 0.0, 0.0));
}
