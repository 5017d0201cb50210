#version 450 core
// One peeled layer of the scene: radiance, inverse depth and ids of the nearest surface behind the last layer's umbra.
// in:  surface.vert's outputs; the previous layer's w where PEEL is defined
// out: radiance (scene-linear, not premultiplied) and opacity; inverse depth w = 1/z in 1/m, negative where the surface
//      is partly transparent; (object + 1, triangle)
// Peeling: Lee, Eisemann & Seidel 2010, section 3.1. Shading: UsdPreviewSurface 2.6.

#include "material.glsl"
#include "lighting.glsl"

in vec3 frag_position;
in vec3 frag_normal;
in vec2 frag_uv;
in vec4 frag_color;
flat in uint frag_instance;

layout(location = 0) out vec4 out_radiance;
layout(location = 1) out float out_w;
layout(location = 2) out uvec2 out_id;

uniform vec3 eye;                // where this view looks from, camera space, m
uniform uint first_object;       // object number of the batch's first instance
uniform float umbra;             // how far in w an opaque surface hides what is behind it, 1/m
#ifdef PEEL
layout(binding = 8) uniform sampler2D previous_w;
#endif

void main()
{
    float w = gl_FragCoord.w;
#ifdef PEEL
    float last_w = texelFetch(previous_w, ivec2(gl_FragCoord.xy), 0).r;
    if (w >= abs(last_w) - (last_w > 0.0 ? umbra : 0.0)) discard;  // a transparent surface hides nothing
#endif
    Surface s = evaluate_material(frag_uv, frag_color, frag_position, frag_normal, gl_FrontFacing);
#ifdef MAY_BE_CLEAR
    if (s.opacity <= 0.0) discard;
#endif
#ifdef UNLIT
    vec3 radiance = s.base_color + s.emissive;
#else
    vec3 radiance = s.emissive + shade(s, frag_position, normalize(eye - frag_position));
#endif
    out_radiance = vec4(min(radiance, vec3(MAX_HALF)), s.opacity);
    out_w = s.opacity >= OPAQUE ? w : -w;
    out_id = uvec2(first_object + frag_instance + 1u, uint(gl_PrimitiveID));
}
