#version 450 core
// Depth of what stands between a light and the scene. Cut-outs and surfaces more than half transparent cast nothing.

#include "material.glsl"

in vec3 frag_position;
in vec3 frag_normal;
in vec2 frag_uv;
in vec4 frag_color;

void main()
{
    if (evaluate_material(frag_uv, frag_color, frag_position, frag_normal, true).opacity < 0.5) discard;
}
