#version 450 core
// Spread of each pixel's light over its circle of confusion.
// in:  light of a field (premultiplied), its radii in pixels, the area of the blur shape (blur_shape.py)
// out: `intensity`: light that each covered pixel gets; `radius_px`: radius in pixels, 0 where there is no light
// Moersch & Hamilton 2014, section 3.2.1, keep light and radius together as well.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D intensity;
layout(r32f, binding = 1) uniform writeonly image2D radius_px;

#include "flag/radius_window.glsl"

uniform sampler2D light;
uniform sampler2D radii;
uniform sampler2D area;     // over radii of 1 / AREA_STEPS pixels
uniform int channel;        // of the radii

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(intensity)))) return;
    float radius = texelFetch(radii, at, 0)[channel];
    vec4 from = radius > 0.0 ? texelFetch(light, at, 0) * window_share(radius) : vec4(0.0);
    radius = from.a > 0.0 ? max(radius, LEAST) : 0.0;
    float spread = textureLod(area, vec2((radius * AREA_STEPS + 0.5) / float(textureSize(area, 0).x), 0.5), 0.0).r;
    imageStore(intensity, at, radius > 0.0 ? from / spread : vec4(0.0));
    imageStore(radius_px, at, vec4(radius));
}
