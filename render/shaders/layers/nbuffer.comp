#version 450 core
// One level of an N-buffer: level i holds at each texel the (min, max) over the 2^i x 2^i square that starts there.
// in:  level i - 1 in `ranges`
// out: level i in `ranges`
// Decoret 2005, "N-Buffers for efficient depth map query", section 3.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) uniform image2DArray ranges;

uniform int level;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    ivec2 last = imageSize(ranges).xy - 1;
    if (any(greaterThan(at, last))) return;
    ivec2 far = min(at + (1 << (level - 1)), last);
    vec2 a = imageLoad(ranges, ivec3(at, level - 1)).xy;
    vec2 b = imageLoad(ranges, ivec3(far.x, at.y, level - 1)).xy;
    vec2 c = imageLoad(ranges, ivec3(at.x, far.y, level - 1)).xy;
    vec2 d = imageLoad(ranges, ivec3(far, level - 1)).xy;
    imageStore(ranges, ivec3(at, level), vec4(min(min(a.x, b.x), min(c.x, d.x)), max(max(a.y, b.y), max(c.y, d.y)), 0.0, 0.0));
}
