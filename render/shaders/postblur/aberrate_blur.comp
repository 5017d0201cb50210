#version 450 core
// Astigmatic blur along one of four directions in turn: the even part along rows and columns, the rest along the radius and
// across it.
// in:  `picture`, `line`; out: `target`, alpha with green
// Kyaw 2013, sections 11.4 and 11.5, with Gaussian weights; taps are a pixel apart along the axis that the line is nearer to

#include "postblur/aberrate.glsl"

uniform int line;  // 0 rows, 1 columns, 2 along the radius, 3 across it

vec4 weights_of(int k, vec4 steps)
{
    vec4 narrow = k == 1 ? steps * steps * 0.5 / max(1.0 - steps * steps, vec4(1e-9)) : vec4(0.0);
    vec4 ratio = float(k) / max(steps, vec4(1e-9));
    vec4 gauss = exp(-0.5 * ratio * ratio) * vec4(lessThanEqual(vec4(float(k)), ceil(SIGMAS * steps)));
    return mix(gauss, narrow, lessThan(steps, vec4(THREE_TAPS)));
}

void main()
{
    ivec2 pixel = own_pixel();
    if (any(greaterThanEqual(pixel, imageSize(target)))) return;
    vec2 place = place_of(pixel), direction = outward_of(place);
    if (line == 3) direction = vec2(-direction.y, direction.x);
    if (line < 2) direction = line == 0 ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
    direction *= narrowed_px();
    float longest = max(abs(direction.x), abs(direction.y));
    vec2 step = direction / longest;
    vec4 steps = longest * errors_at(length(place), line < 2 ? 3 : 3 * line).rgbg;  // standard deviations, in steps
    int last_tap = int(ceil(SIGMAS * max(max(steps.r, steps.g), steps.b)));
    vec4 total = texel(pixel), sum = vec4(1.0);
    for (int k = 1; k <= last_tap; ++k) {
        vec4 weights = weights_of(k, steps);
        if (weights == vec4(0.0)) break;
        total += weights * (bilinear(vec2(pixel) + float(k) * step) + bilinear(vec2(pixel) - float(k) * step));
        sum += 2.0 * weights;
    }
    imageStore(target, pixel, total / sum);
}
