#version 450 core
// Radiance of marked texels: the mean of their finer samples on surfaces that are about as blurred.
// in:  marks; depth and radiance of the finer samples; w of the layers
// out: radiance of the layers

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform image2DArray radiance;

uniform usampler2D marks;
uniform sampler2D depth_map;
uniform sampler2D samples;
uniform sampler2D packed_w;     // layers 0 to 3
uniform int layer_count;        // at most 4
uniform vec2 w_range;           // w of depth 0 and of depth 1
uniform int finer;              // samples per texel along each axis
uniform float alike;            // difference of w within which surfaces are about as blurred

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(texel, textureSize(marks, 0))) || texelFetch(marks, texel, 0).r == 0u) return;
    vec4 stored = texelFetch(packed_w, texel, 0);
    for (int layer = 0; layer < layer_count; ++layer) {
        if (stored[layer] <= 0.0) continue;
        vec4 sum = vec4(0.0);
        for (int i = 0; i < finer * finer; ++i) {
            ivec2 at = finer * texel + ivec2(i % finer, i / finer);
            float depth = texelFetch(depth_map, at, 0).r, w = mix(w_range.x, w_range.y, depth);
            if (depth > 0.0 && abs(w - stored[layer]) < alike) sum += vec4(texelFetch(samples, at, 0).rgb, 1.0);
        }
        if (sum.w > 0.0) imageStore(radiance, ivec3(texel, layer), vec4(sum.rgb / sum.w, 1.0));
    }
}
