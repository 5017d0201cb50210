#version 450 core
// The largest radii in stretches of TILE pixels of each row, near and far.
// in:  radii in pixels of a near and a far field
// out: `widest`, a TILEth as wide
// Moersch & Hamilton 2014, section 5, propose it of square chunks.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) uniform writeonly image2D widest;

uniform sampler2D radii;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(radii, 0);
    if (any(greaterThanEqual(at, imageSize(widest)))) return;
    vec2 most = vec2(0.0);
    for (int x = at.x * TILE; x < min(at.x * TILE + TILE, size.x); ++x) most = max(most, texelFetch(radii, ivec2(x, at.y), 0).rg);
    imageStore(widest, at, vec4(most, 0.0, 0.0));
}
