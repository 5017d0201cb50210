#version 450 core
// The largest value in stretches of TILE pixels of each row, or of each column.
// in:  values of one channel
// out: `widest`, a TILEth as wide, or as high
// Moersch & Hamilton 2014, section 5, propose it of square chunks.

layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) uniform writeonly image2D widest;

uniform sampler2D values;
uniform ivec2 along;    // one step of a stretch

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(values, 0);
    if (any(greaterThanEqual(at, imageSize(widest)))) return;
    ivec2 first = at * (ivec2(1) + (TILE - 1) * along);
    float most = -1.0;
    for (int i = 0; i < TILE; ++i) {
        ivec2 pixel = first + i * along;
        if (all(lessThan(pixel, size))) most = max(most, texelFetch(values, pixel, 0).r);
    }
    imageStore(widest, at, vec4(most));
}
