#version 450 core
// A triangle that covers the target. Draw three vertices without attributes.

void main()
{
    gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.5, 1.0);
}
