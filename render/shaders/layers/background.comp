#version 450 core
// Radiance of rays that meet no surface: the dome, at the direction of each pixel of the layers' view. Alpha is 0.
// in:  the dome's image; focal length and principal point of the view in pixels
// out: radiance, scene-linear

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform image2D background;

uniform sampler2D dome_map;
uniform mat4 dome_from_camera;
uniform vec3 radiance;
uniform vec2 focal_px;
uniform vec2 centre_px;
uniform mat2 unshear;           // from slopes of the picture, right and up, to slopes of space

#include "layers/latlong.glsl"

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(background)))) return;
    vec2 slope = (vec2(pixel) + 0.5 - centre_px) / focal_px;
    vec3 d = normalize(mat3(dome_from_camera) * vec3(unshear * vec2(slope.x, -slope.y), -1.0));
    vec3 colour = radiance * textureLod(dome_map, latlong_uv(d), 0.0).rgb;
    imageStore(background, pixel, vec4(min(colour, vec3(65000.0)), 0.0));
}
