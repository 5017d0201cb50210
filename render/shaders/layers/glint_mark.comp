#version 450 core
// Mark the texels whose nearest opaque surface is out of focus and so uneven that a sample at the texel's centre is not enough.
// in:  the layers
// out: `marks`: 1 where a texel is marked; `found`: whether any is

layout(local_size_x = 8, local_size_y = 8) in;
layout(r8ui, binding = 0) writeonly uniform uimage2D marks;
layout(std430, binding = 0) buffer Found { uint found; };

uniform sampler2D packed_w;     // layers 0 to 3
uniform sampler2DArray radiance;
uniform int layer_count;        // at most 4
uniform ivec2 first;            // texel of these layers in those of the whole picture
uniform float half_width;       // difference of w from that in focus from which on surfaces are out of focus
uniform float least_texels;     // area of the circle of confusion there, texels

#include "layers/sharp_focus.glsl"
#include "highlights/luminance.glsl"

const float VISIBLE = 0.01;     // change of a pixel by a texel's error

// Inverse depth of the nearest opaque surface of a texel and its luminance; 0 where there is none.
vec2 nearest_opaque(ivec2 texel)
{
    vec4 w = texelFetch(packed_w, texel, 0);
    for (int i = 0; i < layer_count; ++i)
        if (w[i] > 0.0) return vec2(w[i], luminance(texelFetch(radiance, ivec3(texel, i), 0).rgb));
    return vec2(0.0);
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), last = textureSize(packed_w, 0) - 1;
    if (any(greaterThan(texel, last))) return;
    float w = nearest_opaque(texel).x;
    uint mark = 0u;
    float blur = abs(w - w_in_focus(vec2(first + texel) + 0.5)) / half_width;
    if (w > 0.0 && blur > 1.0) {
        float least = 1e30, most = 0.0;
        for (int i = 0; i < 9; ++i) {
            float light = nearest_opaque(clamp(texel + ivec2(i % 3, i / 3) - 1, ivec2(0), last)).y;
            least = min(least, light);
            most = max(most, light);
        }
        mark = most - least > VISIBLE * least_texels * blur * blur ? 1u : 0u;
    }
    if (mark > 0u) found = 1u;
    imageStore(marks, texel, uvec4(mark));
}
