#version 450 core
// Spread of each pixel's light over its circle of confusion.
// in:  light of a field (premultiplied), its radii in pixels, the outline of the blur shape (blur_shape.py)
// out: `intensity`: light that each covered pixel gets; `radius_px`: radius in pixels, 0 where there is no light
// Moersch & Hamilton 2014, section 3.2.1, keep light and radius together as well.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D intensity;
layout(r32f, binding = 1) uniform writeonly image2D radius_px;

#include "flag/radius_window.glsl"
#include "layers/outline.glsl"

uniform sampler2D light;
uniform sampler2D radii;
uniform int channel;        // of the radii

float height_at(float dx, float radius)
{
    vec2 extents = reach_at(dx, radius);
    return extents.x + extents.y;
}

// Area that the blurs draw: the sum of the columns' heights. A sum of more columns than the outline has is the integral, less what
// lies beyond the outer columns: to 1e-4.
float drawn_area(float radius)
{
    vec2 ends = radius * span, last = vec2(min(floor(ends.x) + 1.0, 0.0), max(ceil(ends.y) - 1.0, 0.0));
    if (last.y - last.x < float(textureSize(outline, 0).x)) {
        float total = 0.0;
        for (int dx = int(last.x); dx <= int(last.y); ++dx) total += height_at(float(dx), radius);
        return total;
    }
    vec2 outer = vec2(height_at(last.x, radius), height_at(last.y, radius));
    vec2 edge = vec2(height_at(ends.x, radius), height_at(ends.y, radius));
    return radius * radius * unit_area + 0.5 * (outer.x + outer.y - dot(abs(ends - last), outer + edge));
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(intensity)))) return;
    float radius = texelFetch(radii, at, 0)[channel];
    vec4 from = radius > 0.0 ? texelFetch(light, at, 0) * window_share(radius) : vec4(0.0);
    radius = from.a > 0.0 ? max(radius, LEAST) : 0.0;
    imageStore(intensity, at, radius > 0.0 ? from / drawn_area(radius) : vec4(0.0));
    imageStore(radius_px, at, vec4(radius));
}
