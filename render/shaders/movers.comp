#version 450 core
// What moves in each 4x4 block of each layer, and what it sweeps over while the shutter is open.
// in:  w of the layers, four in a texture, and how far their surfaces move (surface.frag)
// out: `fastest`: how far the fastest surface of each block and layer moves, and its w; 0 where nothing does
//      `swept`: for each block, the range of w (as bits, which order as the numbers do) of all that ever is there

layout(local_size_x = 8, local_size_y = 8) in;

#include "carried.glsl"

uniform sampler2D near_w;   // layers 0 to 3
uniform sampler2D far_w;    // layers 4 to 7, where there are so many
uniform sampler2DArray motion;
uniform ivec2 blocks;       // across and down
uniform int layers;

layout(std430, binding = 9) writeonly buffer Fastest { vec4 fastest[]; };
layout(std430, binding = 11) buffer Swept { uvec2 swept[]; };

const float STILL_PX = 0.05;    // what moves by less, none needs look for
const int MAX_STEPS = 1024;

float stored_w(ivec2 pixel, int layer)
{
    return abs(layer < 4 ? texelFetch(near_w, pixel, 0)[layer] : texelFetch(far_w, pixel, 0)[layer - 4]);
}

void sweep(vec2 centre, vec4 mover, vec2 range, float way)
{
    int steps = clamp(int(way / 2.0) + 1, 2, MAX_STEPS);
    ivec2 before = ivec2(-1);
    for (int i = 0; i <= steps; ++i) {
        vec2 place = carried(centre, mover.w, mover.xyz * (float(i) / float(steps) - 0.5));
        ivec2 block = ivec2(floor(place / 4.0));
        if (block == before) continue;
        before = block;
        for (int j = 0; j < 9; ++j) {
            ivec2 at = block + ivec2(j % 3, j / 3) - 1;
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, blocks))) continue;
            atomicMin(swept[at.y * blocks.x + at.x].x, floatBitsToUint(range.x));
            atomicMax(swept[at.y * blocks.x + at.x].y, floatBitsToUint(range.y));
        }
    }
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, blocks))) return;
    ivec2 size = textureSize(near_w, 0);
    vec2 centre = vec2(block * 4 + 2);
    for (int layer = 0; layer < layers; ++layer) {
        vec4 mover = vec4(0.0);
        vec2 range = vec2(3.0e38, 0.0);
        float way = 0.0;
        for (int i = 0; i < 16; ++i) {
            ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
            if (any(greaterThanEqual(pixel, size))) continue;
            float w = stored_w(pixel, layer);
            if (w == 0.0) continue;
            vec4 moved = texelFetch(motion, ivec3(pixel, layer), 0);
            if (moved.w == 0.0) continue;
            float first = at_the_moment(w, -0.5 * moved.z), last = at_the_moment(w, 0.5 * moved.z);
            range = vec2(min(range.x, min(w, min(first, last))), max(range.y, max(w, max(first, last))));
            float px = distance(carried(centre, w, 0.5 * moved.xyz), carried(centre, w, -0.5 * moved.xyz));
            if (px > max(way, STILL_PX)) {
                way = px;
                mover = vec4(moved.xyz, w);
            }
        }
        fastest[(layer * blocks.y + block.y) * blocks.x + block.x] = mover;
        if (range.y > 0.0) sweep(centre, mover.w > 0.0 ? mover : vec4(0.0, 0.0, 0.0, range.y), range * vec2(0.98, 1.02), way);
    }
}
