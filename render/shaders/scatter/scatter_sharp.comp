#version 450 core
// Initial sum of a field's splats: for the far field the sharp pixels, which are in front of all splats.
// in:  a field's light and circles of confusion
// out: `sum`: light that stays in its pixel

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D sum;

#include "scatter/scatter.glsl"

uniform bool is_kept;           // false: the sum starts at 0

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(sum)))) return;
    float c = texelFetch(radii, at, 0)[channel];
    imageStore(sum, at, is_kept ? texelFetch(light, at, 0) * sharp_share(c) : vec4(0.0));
}
