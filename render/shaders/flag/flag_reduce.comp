#version 450 core
// Reduce wide blurs to less resolution: a field's light in a window of radii, and its radii, averaged over squares of
// pixels.
// in:  light of a field (premultiplied), its radii in pixels
// out: `reduced`, a `shrink`th as large on a side, and `reduced_radii` in its own pixels
// Moersch & Hamilton 2014, section 5, propose it for all light; here nearly sharp light keeps its resolution.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D reduced;
layout(rg32f, binding = 1) uniform writeonly image2D reduced_radii;

#include "flag/radius_window.glsl"

uniform sampler2D light;
uniform sampler2D radii;
uniform int channel;
uniform int shrink;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(light, 0);
    if (any(greaterThanEqual(at, imageSize(reduced)))) return;
    vec4 total = vec4(0.0);
    float radius = 0.0;
    for (int i = 0; i < shrink * shrink; ++i) {
        ivec2 pixel = at * shrink + ivec2(i % shrink, i / shrink);
        if (any(greaterThanEqual(pixel, size))) continue;
        float px = texelFetch(radii, pixel, 0)[channel];
        vec4 from = texelFetch(light, pixel, 0) * window_share(px);
        total += from;
        radius += from.a * px;
    }
    imageStore(reduced, at, total / float(shrink * shrink));
    imageStore(reduced_radii, at, vec4(total.a > 0.0 ? radius / total.a / float(shrink) : 0.0, 0.0, 0.0, 0.0));
}
