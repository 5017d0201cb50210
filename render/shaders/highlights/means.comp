#version 450 core
// Mean luminance of blocks of 8x8 layer pixels, over all surfaces of their layers; over the background where there is none.
// in:  layers (march.glsl)
// out: luminance of the surfaces and their number, over 64, in `means`

#include "trace/march.glsl"
#include "highlights/luminance.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 2) uniform writeonly image2D means;

uniform int layer_count;

shared vec2 sums[64];

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    uint place = gl_LocalInvocationIndex;
    vec2 sum = vec2(0.0);
    if (all(lessThan(texel, textureSize(packed_w, 0)))) {
        if (stored_w(texel, 0) == 0.0) sum = vec2(luminance(texelFetch(background, texel, 0).rgb), 1.0);
        for (int layer = 0; layer < layer_count; ++layer) {
            float w = stored_w(texel, layer);
            if (w == 0.0) break;
            sum += vec2(luminance_of(texelFetch(radiance, ivec3(texel, layer), 0), w), 1.0);
        }
    }
    sums[place] = sum;
    barrier();
    for (uint half_count = 32u; half_count > 0u; half_count /= 2u) {
        if (place < half_count) sums[place] += sums[place + half_count];
        barrier();
    }
    if (place == 0u) imageStore(means, ivec2(gl_WorkGroupID.xy), vec4(sums[0] / 64.0, 0.0, 0.0));
}
