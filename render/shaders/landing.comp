#version 450 core
// Which of the things that move may be in each 4x4 block at a moment: the fastest that lands there or beside.
// in:  `fastest` (movers.comp)
// out: `landing`: one more than its place in `fastest`, below its speed; 0 where nothing lands

layout(local_size_x = 64) in;

#include "carried.glsl"

uniform ivec2 blocks;
uniform int count;          // of entries in `fastest`
uniform int index_bits;     // of a key that tell the place

layout(std430, binding = 9) readonly buffer Fastest { vec4 fastest[]; };
layout(std430, binding = 10) buffer Landing { uint landing[]; };

void main()
{
    int number = int(gl_GlobalInvocationID.x);
    if (number >= count) return;
    vec4 mover = fastest[number];
    if (mover.w == 0.0) return;
    int in_layer = number % (blocks.x * blocks.y);
    vec2 centre = vec2(ivec2(in_layer % blocks.x, in_layer / blocks.x) * 4 + 2);
    vec2 place = carried(centre, mover.w, since * mover.xyz);
    float way = distance(carried(centre, mover.w, 0.5 * mover.xyz), carried(centre, mover.w, -0.5 * mover.xyz));
    uint speed = min(uint(16.0 * way), (1u << (32 - index_bits)) - 1u);
    uint key = speed << index_bits | uint(number + 1);
    ivec2 block = ivec2(floor(place / 4.0));
    for (int j = 0; j < 9; ++j) {
        ivec2 at = block + ivec2(j % 3, j / 3) - 1;
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, blocks))) continue;
        atomicMax(landing[at.y * blocks.x + at.x], key);
    }
}
