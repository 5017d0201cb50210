#version 450 core
// Finds the nearest surface behind the last layer's umbra, before anything is shaded: only the depth buffer is written.
// in:  surface.vert's outputs; the previous layer's w (1/m, negative where partly transparent) where PEEL is defined;
//      the layer's own w where FILL is defined, which leaves alone what is there
// Peeling: Lee, Eisemann & Seidel 2010, section 3.1.

#ifdef MAY_BE_CLEAR
#include "material.glsl"

in vec3 frag_position;
in vec3 frag_normal;
in vec2 frag_uv;
in vec4 frag_color;
#endif

#ifdef PEEL
layout(binding = 8) uniform sampler2D previous_w;
uniform int previous_channel;
uniform float umbra;  // how far in w an opaque surface hides what is behind it, 1/m
#endif

#ifdef FILL
layout(binding = 11) uniform sampler2D own_w;
uniform int own_channel;
#endif

void main()
{
#if defined(PEEL) || defined(MAY_BE_CLEAR)
    bool hidden = false;
#endif
#ifdef PEEL
    float last_w = texelFetch(previous_w, ivec2(gl_FragCoord.xy), 0)[previous_channel];
    hidden = gl_FragCoord.w >= abs(last_w) - (last_w > 0.0 ? umbra : 0.0);  // a transparent surface hides nothing
#endif
#ifdef FILL
    hidden = hidden || texelFetch(own_w, ivec2(gl_FragCoord.xy), 0)[own_channel] != 0.0;
#endif
#ifdef MAY_BE_CLEAR
    // before any discard: look-ups need their neighbours' coordinates
    hidden = evaluate_material(frag_uv, frag_color, frag_position, frag_normal, gl_FrontFacing).opacity < LEAST_OPACITY || hidden;
#endif
#if defined(PEEL) || defined(MAY_BE_CLEAR)
    if (hidden) discard;
#endif
}
