#version 450 core
// List the blocks of 8x8 pixels of a layer that hold surfaces.
// in:  w of the layer
// out: their number, and the place of each in blocks, x in the lower half: in any order

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) buffer Blocks { uint count; uint blocks[]; };

uniform sampler2D w_map;
uniform int channel;            // the layer's channel of w

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy), size = textureSize(w_map, 0);
    bool is_empty = true;
    for (int i = 0; i < 64 && is_empty; ++i) {
        ivec2 pixel = 8 * block + ivec2(i & 7, i >> 3);
        if (all(lessThan(pixel, size))) is_empty = texelFetch(w_map, pixel, 0)[channel] == 0.0;
    }
    if (!is_empty) blocks[atomicAdd(count, 1u)] = uint(block.x) | uint(block.y) << 16;
}
