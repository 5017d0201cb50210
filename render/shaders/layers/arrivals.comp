#version 450 core
// Movers that may be in each 4x4 block at a moment: the fastest that arrives there or beside it, and the nearest.
// in:  `movers` (movers.comp)
// out: `arrivals`: for each block the greatest speed and w of arriving movers (as bits, which sort like the numbers), and the index
//      in `movers` of each, plus 1; 0 where none arrives. Speeds and w are found first; the pass with `writes_indices` then writes
//      the indices.

layout(local_size_x = 8, local_size_y = 8) in;

#include "layers/carried.glsl"

uniform sampler2DArray movers;
uniform ivec2 blocks;
uniform int layers;
uniform bool writes_indices;

layout(std430, binding = 3) buffer Arrivals { uvec4 arrivals[]; };

void add_arrival(ivec2 block, int slice)
{
    vec4 mover = texelFetch(movers, ivec3(block, slice), 0);
    if (mover.w == 0.0) return;
    vec2 centre = vec2(block * 4 + 2), place = carried(centre, mover.w, shutter_time * mover.xyz);
    uint speed = floatBitsToUint(length(drift(centre, mover.w, mover.xyz)) + 1e-3);
    uint w = floatBitsToUint(at_the_moment(mover.w, shutter_time * mover.z));
    uint number = uint((slice * blocks.y + block.y) * blocks.x + block.x) + 1u;
    ivec2 to = ivec2(floor(clamp(place, vec2(-8.0), vec2(blocks * 4 + 8)) / 4.0));
    for (int j = 0; j < 9; ++j) {
        ivec2 at = to + ivec2(j % 3, j / 3) - 1;
        if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, blocks))) continue;
        int i = at.y * blocks.x + at.x;
        if (!writes_indices) {
            atomicMax(arrivals[i].x, speed);
            atomicMax(arrivals[i].y, w);
        } else {
            if (arrivals[i].x == speed) atomicMax(arrivals[i].z, number);
            if (arrivals[i].y == w) atomicMax(arrivals[i].w, number);
        }
    }
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, blocks))) return;
    int in_half = shutter_time < 0.0 ? 0 : 1;
    for (int i = 0; i < 2 * layers; ++i) add_arrival(block, 4 * (i / 2) + 2 * (i % 2) + in_half);
}
