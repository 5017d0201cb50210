#version 450 core
// Reduce wide splats to less resolution: light of pixels whose circles of confusion are within bounds, averaged over
// squares of pixels.
// in:  a field's light (premultiplied) and circles of confusion in pixels
// out: `reduced`, a `shrink`th as large on a side, and `reduced_radii` in its own pixels
// Kyaw 2013, chapter 9, proposes a target of half the size for wide spots.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D reduced;
layout(r32f, binding = 1) uniform writeonly image2D reduced_radii;

#include "scatter/scatter.glsl"

uniform int shrink;
uniform vec2 bounds;            // circles of confusion, in pixels of the light

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(light, 0);
    if (any(greaterThanEqual(at, imageSize(reduced)))) return;
    vec4 total = vec4(0.0);
    float radius = 0.0;
    for (int i = 0; i < shrink * shrink; ++i) {
        ivec2 pixel = at * shrink + ivec2(i % shrink, i / shrink);
        if (any(greaterThanEqual(pixel, size))) continue;
        float c = texelFetch(radii, pixel, 0)[channel];
        if (c < bounds.x || c >= bounds.y) continue;
        vec4 from = texelFetch(light, pixel, 0);
        total += from;
        radius += from.a * c;
    }
    imageStore(reduced, at, total / float(shrink * shrink));
    imageStore(reduced_radii, at, vec4(total.a > 0.0 ? radius / total.a / float(shrink) : 0.0, 0.0, 0.0, 0.0));
}
