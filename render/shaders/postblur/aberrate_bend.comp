#version 450 core
// Distortion and lateral colour: sample each channel of a pixel at its source in the error-free picture.
// in:  `picture` (premultiplied, scene-linear); out: `target`, alpha with green
// Kyaw 2013, section 11.4; Catmull-Rom cubic, clamped to its four nearest texels

#include "postblur/aberrate.glsl"

float catmull_rom(float distance)
{
    float t = abs(distance);
    if (t < 1.0) return 1.0 + t * t * (1.5 * t - 2.5);
    return t < 2.0 ? 2.0 + t * (t * (2.5 - 0.5 * t) - 4.0) : 0.0;
}

vec4 cubic(vec2 at)
{
    ivec2 low = ivec2(floor(at));
    vec2 part = at - vec2(low);
    vec4 total = vec4(0.0), least = vec4(3.4e38), most = vec4(-3.4e38);
    for (int j = -1; j <= 2; ++j) {
        for (int i = -1; i <= 2; ++i) {
            vec4 value = texel(low + ivec2(i, j));
            total += catmull_rom(part.x - float(i)) * catmull_rom(part.y - float(j)) * value;
            if ((i | j) >= 0 && i < 2 && j < 2) {
                least = min(least, value);
                most = max(most, value);
            }
        }
    }
    return clamp(total, least, most);
}

void main()
{
    ivec2 pixel = own_pixel();
    if (any(greaterThanEqual(pixel, imageSize(target)))) return;
    vec2 place = place_of(pixel);
    vec3 source = errors_at(length(place), 0);
    vec2 off = place * narrowed_px();
    vec4 green = cubic(vec2(pixel) + off * (source.g - 1.0));
    float red = source.r == source.g ? green.r : cubic(vec2(pixel) + off * (source.r - 1.0)).r;
    float blue = source.b == source.g ? green.b : cubic(vec2(pixel) + off * (source.b - 1.0)).b;
    imageStore(target, pixel, vec4(red, green.g, blue, green.a));
}
