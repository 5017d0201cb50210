#version 450 core
// Lay out the exposed light for its Fourier transform: mirrored at the picture's edges, as far as halation reaches.
// out: (R + iG, B + i0) for each place, row by row

layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Padded { vec4 padded[]; };

#include "film/film_light.glsl"

uniform ivec2 size;   // size of the transform
uniform ivec2 reach;  // position of the picture's corner in it

ivec2 mirrored(ivec2 place, ivec2 period)
{
    ivec2 folded = (place + period * (reach / period + 1)) % period;  // % needs a number of 0 or more
    return min(folded, period - 1 - folded);
}

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    ivec2 pixel = mirrored(place - reach, 2 * textureSize(light, 0));
    padded[place.y * size.x + place.x] = vec4(exposed_at(pixel), 0.0);
}
