#version 450 core
// Bins of inverse depth that hold a surface in a 4x4 block, in any layer.
// in:  w of the layers, four in a texture (1/m; 0 empty, negative partly transparent), and its slopes; the
//      bins' range
// out: 64 bits in slice 0

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32ui, binding = 0) writeonly uniform uimage2DArray bins;

#include "layers/bins.glsl"
#include "trace/slopes.glsl"

uniform sampler2D near_w;  // layers 0 to 3
uniform sampler2D far_w;   // layers 4 to 7, if any
uniform usampler2D near_slopes;
uniform usampler2D far_slopes;
uniform bool two_packs;
uniform vec2 w_range;       // range of w of all bins
#ifdef MOVERS
layout(std430, binding = 1) readonly buffer Swept { uvec2 swept[]; };  // range of w of the movers through each block (movers.comp)
#endif

uvec2 joined(uvec2 held, vec4 stored, uvec4 slopes)
{
    vec4 w = abs(stored), reach = w * reach_of(slopes);
    for (int i = 0; i < 4; ++i) {
        if (stored[i] == 0.0) break;  // after an empty layer, all are empty
        held |= bits_between(bin_of(w[i] - reach[i], w_range), bin_of(w[i] + reach[i], w_range));
    }
    return held;
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(block, imageSize(bins).xy))) return;
    ivec2 size = textureSize(near_w, 0);
    uvec2 held = uvec2(0u);
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, size))) continue;
        held = joined(held, texelFetch(near_w, pixel, 0), texelFetch(near_slopes, pixel, 0));
        if (two_packs) held = joined(held, texelFetch(far_w, pixel, 0), texelFetch(far_slopes, pixel, 0));
    }
#ifdef MOVERS
    vec2 through = uintBitsToFloat(swept[block.y * imageSize(bins).x + block.x]);
    if (through.y > 0.0) held |= bits_between(bin_of(through.x, w_range), bin_of(through.y, w_range));
#endif
    imageStore(bins, ivec3(block, 0), uvec4(held, 0u, 0u));
}
