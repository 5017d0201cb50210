#version 450 core
// Colour pass of a peel: radiance, inverse depth and ids of the surfaces that layers/depth.frag found.
// in:  surface.vert's outputs; OWN_LIGHT is defined where the surface shows what it emits alone
// out: emitted radiance (scene-linear, not premultiplied; where UNLIT is defined, the base colour) and alpha (coverage.glsl); inverse depth
//      w from the view's base in 1/m, negative where the surface is partly transparent; (object + 1, triangle); the slope of w (slopes.glsl);
//      where MOTION is defined, the surface's motion while the shutter is open (carried.glsl); where UNLIT is not, the surface
//      that light falls on (reflector.glsl), for shade.comp
// Shading: UsdPreviewSurface 2.6. What opacity does not fade is divided by it here and in shade.comp, since layers hold light that is
// not premultiplied.

#include "layers/material.glsl"
#include "layers/reflector.glsl"
#include "trace/slopes.glsl"

in vec3 frag_position;
in vec3 frag_normal;
in vec2 frag_uv;
in vec4 frag_color;
flat in uint frag_instance;

layout(location = 0) out vec4 out_radiance;
layout(location = 1) out vec4 out_w;     // in every channel; the colour mask keeps the layer's own
layout(location = 2) out uvec2 out_id;
layout(location = 3) out uvec4 out_slope; // in every channel, like w
#ifdef MOTION
#include "layers/drifting.glsl"
layout(location = 4) out uvec4 out_motion;
#endif
#ifndef UNLIT
layout(location = 5) out vec4 out_albedo;       // albedo, roughness
layout(location = 6) out vec4 out_reflectance;  // reflectance at normal incidence, occlusion
layout(location = 7) out vec4 out_normal;       // normal in octahedral coordinates; amount and roughness of the clear coat
#endif

uniform uint first_object;       // object number of the batch's first instance
uniform uint first_triangle;     // first triangle of the draw
#ifdef LINKED
uniform uint link_set;           // set of lights that leave the surface out (lighting.glsl)
#endif
uniform bool is_holdout;         // hides what is behind it, and gives neither light nor coverage

void main()
{
    float w = fragment_w();
    vec2 slope = vec2(dFdx(w), dFdy(w)) / w;  // before any discard
    Surface s = evaluate_material(frag_uv, frag_color, frag_position, frag_normal, gl_FrontFacing);
#ifdef MAY_BE_TRANSPARENT
    if (s.opacity < LEAST_OPACITY) discard;  // it may share its depth with an opaque surface
#endif
#if defined(UNLIT) && !defined(OWN_LIGHT)
    vec3 radiance = s.base_color;
#else
    vec3 radiance = s.emissive;
#endif
#ifndef UNLIT
    out_albedo = vec4(min((1.0 - s.metallic) * s.base_color, vec3(MAX_HALF)), s.roughness);
    out_reflectance = vec4(min(s.f0, vec3(MAX_HALF)), s.occlusion);
    out_normal = vec4(octahedral(s.normal), s.clearcoat, s.clearcoat_roughness);
    float sum = dot(out_albedo, vec4(1.0)) + dot(out_reflectance, vec4(1.0)) + dot(out_normal, vec4(1.0));
    if (isnan(sum) || isinf(sum)) {  // an invalid surface reflects nothing
        out_albedo = vec4(0.0, 0.0, 0.0, 1.0);
        out_reflectance = vec4(0.0);
        out_normal = vec4(0.5, 0.5, 0.0, 1.0);
    }
#ifdef LINKED
    out_normal.z = (float(link_set) * 256.0 + floor(clamp(out_normal.z, 0.0, 1.0) * 255.0 + 0.5)) / 65535.0;
#endif
#ifdef OWN_LIGHT
    out_albedo = vec4(0.0);  // roughness 0: not lit (shade_list.comp)
#endif
#endif
    if (any(isnan(radiance)) || any(isinf(radiance))) radiance = vec3(0.0);  // invalid light counts as none
    bool opaque = s.opacity >= OPAQUE;
#if !defined(UNLIT) && !defined(OWN_LIGHT)
    if (s.is_glass && !opaque) {
        radiance /= s.opacity;
        out_albedo.a = -out_albedo.a;
    }
#endif
    out_radiance = vec4(min(radiance, vec3(MAX_HALF)), opaque ? 1.0 : s.opacity);
    if (is_holdout) out_radiance = vec4(vec3(0.0), opaque ? 0.0 : -s.opacity);
    out_w = vec4(opaque ? w : -w);
    out_slope = uvec4(packed_slope(slope));
#ifdef MOTION
    out_motion = packed_motion(own_first(), own_second(), drifts());
#endif
    out_id = uvec2(first_object + frag_instance + 1u, first_triangle + uint(gl_PrimitiveID));
}
