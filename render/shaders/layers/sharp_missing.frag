#version 450 core
// Depth buffer of the sharp layer: the nearest depth, which no surface equals, except where a surface is missing.
// in:  w of the sharp layer: negative where a surface is still to be shaded

uniform sampler2D sharp_w;

void main()
{
    if (texelFetch(sharp_w, ivec2(gl_FragCoord.xy), 0).r < 0.0) discard;
    gl_FragDepth = 1.0;
}
