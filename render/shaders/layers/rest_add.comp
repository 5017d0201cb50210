#version 450 core
// Composite one more surface of each pixel behind those before it.
// in:  w of the surface (1/m; 0 where there is none, negative where partly transparent), its radiance and opacity
// out: premultiplied radiance and opacity of all so far, in `light`

#include "layers/coverage.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D light;

uniform sampler2D w;
uniform sampler2DArray radiance;

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(light)))) return;
    float stored = texelFetch(w, pixel, 0).r;
    if (stored == 0.0) return;
    vec4 surface = texelFetch(radiance, ivec3(pixel, 0), 0), total = imageLoad(light, pixel);
    total += (1.0 - total.a) * opacity_of(surface, stored > 0.0) * vec4(surface.rgb, 1.0);
    imageStore(light, pixel, total);
}
