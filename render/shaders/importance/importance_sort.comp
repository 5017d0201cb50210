#version 450 core
// Scatter of a counting sort: order the changed pixels by importance. The sort is stable, on every device.
// in:  `waiting` (importance_bucket.glsl), first positions of the buckets' parts (importance_scan.comp)
// out: `order`: numbers of pixels, the half tile's 32 times and its own within it

layout(local_size_x = 64) in;
layout(r32ui, binding = 2) uniform readonly uimage2D waiting;
layout(std430, binding = 5) writeonly buffer Order { uint order[]; };
layout(std430, binding = 6) readonly buffer Counts { uint counts[]; };

uniform uint chunks;
uniform ivec2 tiles;

shared uint places[64 * 64];    // by invocation and bucket

uint bucket_of(int lane, int i)
{
    ivec2 tile = ivec2((lane >> 1) % tiles.x, (lane >> 1) / tiles.x);
    ivec2 at = tile * 8 + ivec2(i & 7, (lane & 1) * 4 + (i >> 3));
    return tile.y >= tiles.y || any(greaterThanEqual(at, imageSize(waiting))) ? 0u : imageLoad(waiting, at).r & 255u;
}

void main()
{
    int lane = int(gl_GlobalInvocationID.x);
    uint own = gl_LocalInvocationID.x;
    for (uint bucket = 0u; bucket < 64u; ++bucket) places[own * 64u + bucket] = 0u;
    for (int i = 0; i < 32; ++i) places[own * 64u + bucket_of(lane, i)] += 1u;
    barrier();
    uint at = counts[own * chunks + gl_WorkGroupID.x]; // here an invocation is a bucket
    for (uint other = 0u; other < 64u; ++other) {
        uint count = places[other * 64u + own];
        places[other * 64u + own] = at;
        at += count;
    }
    barrier();
    for (int i = 0; i < 32; ++i) {
        uint bucket = bucket_of(lane, i);
        if (bucket == 0u) continue;
        uint place = places[own * 64u + bucket];
        places[own * 64u + bucket] = place + 1u;
        order[place] = uint(lane) * 32u + uint(i);
    }
}
