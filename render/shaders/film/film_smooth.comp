#version 450 core
// Convolve a field with a kernel along one axis; it gets shorter by the kernel's reach at both ends.
// in:  four numbers for each place, row by row; the kernel's weights; AXIS
// out: the same, of `size`

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Source { vec4 source[]; };
layout(std430, binding = 1) writeonly buffer Target { vec4 target[]; };
layout(std430, binding = 2) readonly buffer Kernel { float kernel[]; };

uniform ivec2 size;
uniform int source_width;

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, size))) return;
    int from = place.y * source_width + place.x, stride = AXIS == 0 ? 1 : source_width;
    vec4 sum = vec4(0.0);
    for (int i = 0; i < kernel.length(); ++i) sum += kernel[i] * source[from + stride * i];
    target[place.y * size.x + place.x] = sum;
}
