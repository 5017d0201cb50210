#version 450 core
// White noise for a picture and a margin as wide as the grain's kernel.
// out: four normal numbers for each place, row by row

layout(local_size_x = 64) in;
layout(std430, binding = 0) writeonly buffer Noise { vec4 noise[]; };

#include "film/noise.glsl"

uniform ivec2 size;
uniform ivec2 first;  // pixel of the picture that the first number belongs to

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    noise[place.y * size.x + place.x] = normal_noise(first + place);
}
