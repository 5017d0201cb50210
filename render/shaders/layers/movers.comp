#version 450 core
// Moving surfaces in each 4x4 block of each layer, and the range of inverse depth that they sweep while the shutter is
// open.
// in:  w of the layers, four in a texture, and the motion of their surfaces (surface.frag)
// out: `movers`: for each layer, the fastest and the slowest moving surface of the block, in the first and in the second half of
//      the exposure: its motion (motion_in_half) and its w; 0 where none moves
//      `swept`: for each block, the range of w (as bits, which sort like the numbers) of all surfaces that pass through it

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform image2DArray movers;     // slices: layer, fastest or slowest, half

#include "layers/carried.glsl"

uniform sampler2D near_w;   // layers 0 to 3
uniform sampler2D far_w;    // layers 4 to 7, if any
uniform usampler2DArray motion;
uniform ivec2 blocks;       // across and down
uniform int layers;

layout(std430, binding = 1) buffer Swept { uvec2 swept[]; };

const int MAX_STEPS = 1024;

float stored_w(ivec2 pixel, int layer)
{
    return abs(layer < 4 ? texelFetch(near_w, pixel, 0)[layer] : texelFetch(far_w, pixel, 0)[layer - 4]);
}

void sweep(vec2 centre, vec4 mover, vec2 range, float half_way)
{
    vec2 to = carried(centre, mover.w, half_way * mover.xyz);
    int steps = 1 + int(min(0.5 * distance(centre, to), float(MAX_STEPS - 1)));
    ivec2 before = ivec2(-9);
    for (int i = 0; i <= steps; ++i) {
        vec2 place = carried(centre, mover.w, mover.xyz * half_way * float(i) / float(steps));
        ivec2 block = ivec2(floor(clamp(place, vec2(-8.0), vec2(blocks * 4 + 8)) / 4.0));
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

void find(ivec2 block, int layer, int in_half)
{
    float half_way = in_half == 0 ? -0.5 : 0.5;
    vec4 fastest = vec4(0.0), slowest = vec4(0.0);
    vec2 range = vec2(3.0e38, 0.0);
    float most = -1.0, least = 1e30;
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, textureSize(near_w, 0)))) continue;
        float w = stored_w(pixel, layer);
        if (w == 0.0) continue;
        uvec4 stored = texelFetch(motion, ivec3(pixel, layer), 0);
        if (stored.w == 0u) continue;
        vec3 moves = motion_in_half(stored, in_half == 1);
        float then = at_the_moment(w, half_way * moves.z), px = length(drift(vec2(pixel) + 0.5, w, moves));
        range = vec2(min(range.x, min(w, then)), max(range.y, max(w, then)));
        if (px > most) { most = px; fastest = vec4(moves, w); }
        if (px < least) { least = px; slowest = vec4(moves, w); }
    }
    imageStore(movers, ivec3(block, 4 * layer + in_half), fastest);
    imageStore(movers, ivec3(block, 4 * layer + 2 + in_half), slowest);
    if (range.y == 0.0) return;
    vec2 centre = vec2(block * 4 + 2);
    range *= vec2(0.98, 1.02);
    sweep(centre, fastest, range, half_way);
    if (most > least + 1.0) sweep(centre, slowest, range, half_way);
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, blocks))) return;
    for (int i = 0; i < 2 * layers; ++i) find(block, i / 2, i % 2);
}
