#version 450 core
// Depth buffer of finer samples: the nearest depth, which no surface equals, except in marked texels.
// in:  marks of texels

uniform usampler2D marks;
uniform int finer;              // samples per texel along each axis

void main()
{
    if (texelFetch(marks, ivec2(gl_FragCoord.xy) / finer, 0).r > 0u) discard;
    gl_FragDepth = 1.0;
}
