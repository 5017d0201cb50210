#version 450 core
// Depth pass of a peel: the nearest surface behind the last layer's umbra. Only the depth buffer is written.
// in:  surface.vert's outputs; the previous layer's w (1/m, negative where partly transparent) where PEEL is defined;
//      the reach of lens rays (reach_spread.comp) where REACH is defined; the layer's own w where FILL is defined, which keeps
//      filled pixels; where MOST_OPAQUE is defined, pixels with fewer opaque surfaces in front are drawn; where MOTION is defined,
//      the motion of the surfaces of the previous layer and of this one; where REST is defined, w of the last layer and the light
//      of what it does not hold (render/layers/rest.py)
// Peeling: Lee, Eisemann & Seidel 2010, section 3.1.

#ifdef MAY_BE_TRANSPARENT
#include "layers/material.glsl"

in vec3 frag_position;
in vec3 frag_normal;
in vec2 frag_uv;
in vec4 frag_color;
#endif

#include "layers/fragment_w.glsl"

#ifdef PEEL
layout(binding = 8) uniform sampler2D previous_w;
uniform int previous_channel;
uniform float umbra;  // reach of an opaque surface's umbra in w, 1/m
#ifdef REACH
#include "trace/slopes.glsl"
layout(binding = 13) uniform sampler2D reach;  // greatest w of what lens rays may meet here, 1/m (render/layers/reach.py)
#endif
#ifdef MOST_OPAQUE
layout(binding = 14) uniform sampler2D first_w; // w of the first four layers
uniform int most_opaque;
uniform int packs;      // 2 where the previous layer is one of the second four

int opaque_of(vec4 w)
{
    return int(dot(step(1e-30, w), vec4(1.0)));
}
#endif
#ifdef MOTION
#include "layers/drifting.glsl"
layout(binding = 12) uniform usampler2DArray previous_motion;
uniform int previous_layer;

// Greatest distance, px, by which this surface and the one in front of it move apart, in either half of the exposure.
float parting(float last_w)
{
    uvec4 stored = texelFetch(previous_motion, ivec3(ivec2(gl_FragCoord.xy), previous_layer), 0);
    vec2 at = gl_FragCoord.xy;
    float w = gl_FragCoord.w, last = abs(last_w);
    vec2 first = drift(at, w, own_first()) - 0.5 * drift(at, last, motion_in_half(stored, false));
    vec2 second = drift(at, w, own_second()) - 0.5 * drift(at, last, motion_in_half(stored, true));
    return max(length(first), length(second));
}
#endif
#endif

#if defined(FILL) || defined(REST)
layout(binding = 11) uniform sampler2D own_w;
uniform int own_channel;
#endif
#ifdef REST
layout(binding = 15) uniform sampler2D rest_light;
#endif

void main()
{
#ifdef REACH
    float w = fragment_w(), change = min(abs(dFdx(w)) + abs(dFdy(w)), 2.0 * LONGEST_REACH * w);   // before any discard
    float farthest = w - change - UNLIKE * w;   // of what a ray may take for this surface
#endif
#if defined(PEEL) || defined(FILL) || defined(REST) || defined(MAY_BE_TRANSPARENT)
    bool hidden = false;
#endif
#ifdef PEEL
    float last_w = texelFetch(previous_w, ivec2(gl_FragCoord.xy), 0)[previous_channel];
    float shadowed = last_w > 0.0 ? umbra : 0.0;  // a transparent surface hides nothing
#ifdef MOTION
    shadowed *= max(0.0, 1.0 - parting(last_w));  // nor does one that moves away
#endif
    hidden = fragment_w() >= abs(last_w) - shadowed;
#ifdef REACH
    hidden = hidden || farthest > texelFetch(reach, ivec2(gl_FragCoord.xy) / REACH_BLOCK, 0).x;
#endif
#ifdef MOST_OPAQUE
    int in_front = opaque_of(texelFetch(first_w, ivec2(gl_FragCoord.xy), 0));
    if (packs > 1) in_front += opaque_of(texelFetch(previous_w, ivec2(gl_FragCoord.xy), 0));
    hidden = hidden || in_front >= most_opaque;
#endif
#endif
#ifdef FILL
    hidden = hidden || texelFetch(own_w, ivec2(gl_FragCoord.xy), 0)[own_channel] != 0.0;
#endif
#ifdef REST
    float last_held = texelFetch(own_w, ivec2(gl_FragCoord.xy), 0)[own_channel];
    hidden = hidden || (last_held > 0.0 ? fragment_w() <= last_held : fragment_w() >= -last_held);
    hidden = hidden || texelFetch(rest_light, ivec2(gl_FragCoord.xy), 0).a >= OPAQUE;
#endif
#ifdef MAY_BE_TRANSPARENT
    // before any discard: texture look-ups need the neighbours' derivatives
    hidden = evaluate_material(frag_uv, frag_color, frag_position, frag_normal, gl_FrontFacing).opacity < LEAST_OPACITY || hidden;
#endif
#if defined(PEEL) || defined(FILL) || defined(REST) || defined(MAY_BE_TRANSPARENT)
    if (hidden) discard;
#endif
}
