#version 450 core
// Scan of a counting sort: the first position of each bucket and chunk in the order. One work group.
// in:  `counts` of each bucket in each chunk (importance_bucket.glsl)
// out: `counts`: first positions, the most important bucket first

layout(local_size_x = 64) in;
layout(std430, binding = 6) buffer Counts { uint counts[]; };

uniform uint chunks;

shared uint totals[64];

void main()
{
    uint turn = gl_LocalInvocationID.x, bucket = 63u - turn;
    uint total = 0u;
    if (bucket > 0u)
        for (uint chunk = 0u; chunk < chunks; ++chunk) total += counts[bucket * chunks + chunk];
    totals[turn] = total;
    barrier();
    uint at = 0u;
    for (uint before = 0u; before < turn; ++before) at += totals[before];
    if (bucket > 0u)
        for (uint chunk = 0u; chunk < chunks; ++chunk) {
            uint count = counts[bucket * chunks + chunk];
            counts[bucket * chunks + chunk] = at;
            at += count;
        }
}
