#version 450 core
// Replace the radiance of highlights by what rays are to see of them, or put it back.
// in:  highlights: texel (x | y << 16, layer), replacement and original, four halves each
// out: `radiance` of those texels

layout(local_size_x = 64) in;
layout(rgba16f, binding = 2) uniform writeonly image2DArray radiance;

struct Taken { uvec2 texel; uvec2 base; uvec2 exact; };
layout(std430, binding = 0) readonly buffer Takens { Taken taken[]; };

uniform int count;
uniform bool put_back;

void main()
{
    int i = int(gl_GlobalInvocationID.x);
    if (i >= count) return;
    uvec2 texel = taken[i].texel, held = put_back ? taken[i].exact : taken[i].base;
    imageStore(radiance, ivec3(texel.x & 0xffffu, texel.x >> 16, texel.y), vec4(unpackHalf2x16(held.x), unpackHalf2x16(held.y)));
}
