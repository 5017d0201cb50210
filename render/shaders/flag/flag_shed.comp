#version 450 core
// Light that each pixel scatters on every pixel of its circle of confusion, and the circle's radius.
// in:  light of a field (premultiplied), its radii in pixels, the light of a spread point (blur_shape.py)
// out: `shed`: light on one pixel; `reach`: radius in pixels, 0 where nothing is shed
// Moersch & Hamilton 2014, section 3.2.1, keep light and radius together as well.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D shed;
layout(r32f, binding = 1) uniform writeonly image2D reach;

#include "flag/flag_window.glsl"

uniform sampler2D light;
uniform sampler2D radii;
uniform sampler2D area;     // over radii of 1 / AREA_STEPS pixels
uniform int channel;        // of the radii

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(shed)))) return;
    float radius = texelFetch(radii, at, 0)[channel];
    vec4 from = radius > 0.0 ? texelFetch(light, at, 0) * window_share(radius) : vec4(0.0);
    radius = from.a > 0.0 ? max(radius, LEAST) : 0.0;
    float spread = textureLod(area, vec2((radius * AREA_STEPS + 0.5) / float(textureSize(area, 0).x), 0.5), 0.0).r;
    imageStore(shed, at, radius > 0.0 ? from / spread : vec4(0.0));
    imageStore(reach, at, vec4(radius));
}
