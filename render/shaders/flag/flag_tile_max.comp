#version 450 core
// Maximum of each tile of TILE pixels of a row, or of a column.
// in:  values of one channel
// out: `maxima`, a TILEth as wide or as high
// Moersch & Hamilton 2014, section 5, propose it for square chunks.

layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) uniform writeonly image2D maxima;

uniform sampler2D values;
uniform ivec2 along;    // one step along a tile

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(values, 0);
    if (any(greaterThanEqual(at, imageSize(maxima)))) return;
    ivec2 first = at * (ivec2(1) + (TILE - 1) * along);
    float most = -1.0;
    for (int i = 0; i < TILE; ++i) {
        ivec2 pixel = first + i * along;
        if (all(lessThan(pixel, size))) most = max(most, texelFetch(values, pixel, 0).r);
    }
    imageStore(maxima, at, vec4(most));
}
