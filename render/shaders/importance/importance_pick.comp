#version 450 core
// Pick the pixels of the order that are spread now.
// in:  `order` (importance_sort.comp), from `first` to before `end`
// out: `picked`: a bit for each pixel of a half tile

layout(local_size_x = 64) in;
layout(std430, binding = 5) buffer Picked { uint picked[]; };
layout(std430, binding = 6) readonly buffer Order { uint order[]; };

uniform uint first;
uniform uint end;

void main()
{
    uint turn = first + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (turn >= end) return;
    atomicOr(picked[order[turn] >> 5], 1u << (order[turn] & 31u));
}
