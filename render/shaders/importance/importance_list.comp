#version 450 core
// List the marked tiles.

layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Listed { uint listed_count; uint listed[]; };
layout(std430, binding = 4) readonly buffer Marked { uint marked[]; };

uniform uint count;

void main()
{
    uint tile = gl_GlobalInvocationID.x;
    if (tile < count && marked[tile] != 0u) listed[atomicAdd(listed_count, 1u)] = tile;
}
