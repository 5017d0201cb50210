#version 450 core
// One level of an N-buffer of bins: level i holds at each texel the bins of the 2^i x 2^i square that starts there.
// in:  level i - 1 in `bins`
// out: level i in `bins`
// Decoret 2005, "N-Buffers for efficient depth map query", section 3, with "any of" in place of the minimum and maximum.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32ui, binding = 0) uniform uimage2DArray bins;

uniform int level;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 last = imageSize(bins).xy - 1;
    if (any(greaterThan(at, last))) return;
    ivec2 far = min(at + (1 << (level - 1)), last);
    uvec2 held = imageLoad(bins, ivec3(at, level - 1)).xy | imageLoad(bins, ivec3(far.x, at.y, level - 1)).xy
               | imageLoad(bins, ivec3(at.x, far.y, level - 1)).xy | imageLoad(bins, ivec3(far, level - 1)).xy;
    imageStore(bins, ivec3(at, level), uvec4(held, 0u, 0u));
}
