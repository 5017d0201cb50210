#version 450 core
// Puts the pixels that have changed in the order of their importance: the scatter of a counting sort. Of equals the first comes first,
// on every device.
// in:  `waiting` (importance_compare.comp), where the buckets' parts begin (importance_scan.comp)
// out: `order`: numbers of pixels

layout(local_size_x = 64) in;
layout(r32ui, binding = 0) uniform readonly uimage2D waiting;
layout(std430, binding = 5) writeonly buffer Order { uint order[]; };
layout(std430, binding = 6) readonly buffer Counts { uint counts[]; };

uniform uint chunks;

shared uint places[64 * 64];    // by lane and bucket

uint bucket_of(uint i, ivec2 size)
{
    int number = int((gl_WorkGroupID.x * 64u + gl_LocalInvocationID.x) * 16u + i);
    return number >= size.x * size.y ? 0u : imageLoad(waiting, ivec2(number % size.x, number / size.x)).r & 255u;
}

void main()
{
    ivec2 size = imageSize(waiting);
    uint lane = gl_LocalInvocationID.x;
    for (uint bucket = 0u; bucket < 64u; ++bucket) places[lane * 64u + bucket] = 0u;
    for (uint i = 0u; i < 16u; ++i) places[lane * 64u + bucket_of(i, size)] += 1u;
    barrier();
    uint at = counts[lane * chunks + gl_WorkGroupID.x]; // here a lane is a bucket
    for (uint other = 0u; other < 64u; ++other) {
        uint count = places[other * 64u + lane];
        places[other * 64u + lane] = at;
        at += count;
    }
    barrier();
    for (uint i = 0u; i < 16u; ++i) {
        uint bucket = bucket_of(i, size);
        if (bucket == 0u) continue;
        uint place = places[lane * 64u + bucket];
        places[lane * 64u + bucket] = place + 1u;
        order[place] = (gl_WorkGroupID.x * 64u + lane) * 16u + i;
    }
}
