#version 450 core
// Coma and vignetting: each pixel is the mean of the picture over the pupil, times the lens's relative light.
// in:  `picture`, `flare` (points of the flare, for a third of its length of 1: along the radius and across it); out: `target`
// Welford 1986, chapter 7: shifted by third * (3x^2 + y^2, 2xy) at the point (x, y) of the pupil

#include "postblur/aberrate.glsl"

layout(std430, binding = 5) readonly buffer Flare { vec2 flare[]; };

uniform int flare_points;  // 0 for no coma

void main()
{
    ivec2 pixel = own_pixel();
    if (any(greaterThanEqual(pixel, imageSize(target)))) return;
    vec2 place = place_of(pixel), along = outward_of(place), across = vec2(-along.y, along.x);
    float height = length(place), third = error_at(height, 12);
    vec4 total = flare_points == 0 ? texel(pixel) : vec4(0.0);
    for (int i = 0; i < flare_points; ++i) {
        vec2 off = third * (flare[i].x * along + flare[i].y * across) * narrowed_px();
        total += bilinear(vec2(pixel) - off) / float(flare_points);
    }
    imageStore(target, pixel, vec4(total.rgb * error_at(height, 13), total.a));
}
