#version 450 core
// Asks for ranges of inverse depth over rectangles of layer pixels, as the tracer does.
// in:  rectangles (low x, low y, high x, high y), N-buffers
// out: (min, max) of each

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Rectangles { ivec4 rectangles[]; };
layout(std430, binding = 1) writeonly buffer Found { vec2 found[]; };

#include "trace/footprints.glsl"

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < rectangles.length()) found[i] = range_over(rectangles[i].xy, rectangles[i].zw);
}
