#version 450 core
// Mean luminance of blocks of 8x8 layer pixels, over all surfaces of their layers; over the background where there is none.
// in:  layers (march.glsl)
// out: luminance of the surfaces and their number, over 64, in `means`

#include "trace/march.glsl"
#include "highlights/luminance.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 2) uniform writeonly image2D means;

uniform int layer_count;

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy), size = textureSize(packed_w, 0);
    if (any(greaterThanEqual(block, imageSize(means)))) return;
    vec2 sum = vec2(0.0);
    for (int i = 0; i < 64; ++i) {
        ivec2 texel = 8 * block + ivec2(i & 7, i >> 3);
        if (any(greaterThanEqual(texel, size))) continue;
        if (stored_w(texel, 0) == 0.0) sum += vec2(luminance(texelFetch(background, texel, 0).rgb), 1.0);
        for (int layer = 0; layer < layer_count; ++layer) {
            float w = stored_w(texel, layer);
            if (w == 0.0) break;
            sum += vec2(luminance_of(texelFetch(radiance, ivec3(texel, layer), 0), w), 1.0);
        }
    }
    imageStore(means, block, vec4(sum / 64.0, 0.0, 0.0));
}
