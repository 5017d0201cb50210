#version 450 core
// Merge the surfaces that a peeling has no layer for into its last two layers. The cases are in render/layers/rest.py.
// in:  premultiplied radiance and opacity of those surfaces; w of the last two layers (negative where partly transparent)
// out: radiance and alpha (coverage.glsl) of the last two layers

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) uniform image2DArray radiance;

uniform sampler2D light;
uniform sampler2D last_w;
uniform sampler2D before_w;
uniform int last_channel;
uniform int before_channel;
uniform int last_slice;
uniform int before_slice;   // last_slice where there is one layer alone

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(light, 0)))) return;
    vec4 rest = texelFetch(light, pixel, 0);
    if (rest.a == 0.0) return;
    bool last_opaque = texelFetch(last_w, pixel, 0)[last_channel] > 0.0;
    bool before_opaque = texelFetch(before_w, pixel, 0)[before_channel] > 0.0;
    ivec3 place = ivec3(pixel, last_opaque && !before_opaque ? before_slice : last_slice);
    vec4 held = imageLoad(radiance, place);
    if (last_opaque && before_opaque) {
        held = rest + (1.0 - rest.a) * held;
    } else {
        held.a = abs(held.a);
        vec4 both = held.a * vec4(held.rgb, 1.0) + (1.0 - held.a) * rest;
        held = vec4(both.rgb / max(both.a, 1e-20), both.a);
    }
    imageStore(radiance, place, held);
}
