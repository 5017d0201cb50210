#version 450 core
// Picks pixels of the order: those that are spread anew now.
// in:  `order` (importance_sort.comp), from `first` to before `end`
// out: `picked`: a bit for each pixel of a tile, 32 in each number

layout(local_size_x = 64) in;
layout(std430, binding = 1) buffer Picked { uint picked[]; };
layout(std430, binding = 5) readonly buffer Order { uint order[]; };

uniform uint first;
uniform uint end;
uniform uint width;
uniform uint tiles_across;

void main()
{
    uint turn = first + gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_WorkGroupID.x * 64u + gl_LocalInvocationID.x;
    if (turn >= end) return;
    uvec2 at = uvec2(order[turn] % width, order[turn] / width);
    uint bit = (at.y & 7u) * 8u + (at.x & 7u);
    atomicOr(picked[((at.y >> 3) * tiles_across + (at.x >> 3)) * 2u + (bit >> 5)], 1u << (bit & 31u));
}
