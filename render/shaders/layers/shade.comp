#version 450 core
// Light that the surfaces of a layer send to the eye, added to what they emit: of quads of 2x2 pixels at once, or of single pixels.
// in:  list of them (shade_list.comp); w of the layer, and its surfaces as the colour pass leaves them (surface.frag); lights, dome
//      and shadows (lighting.glsl)
// out: radiance, scene-linear, not premultiplied; alpha stays, and holdouts stay black (coverage.glsl)
// Deferred shading (Saito & Takahashi 1990, "Comprehensible rendering of 3-D shapes"): a rasteriser shades whole blocks of pixels
// for each small triangle.

#include "layers/stored_reflector.glsl"
#include "layers/lighting.glsl"

layout(local_size_x = 64) in;
layout(rgba16f, binding = 0) uniform image2DArray radiance;
layout(std430, binding = 0) readonly buffer Listed { uint quads; uint pixels; uint places[]; };

uniform sampler2D w_map;
uniform float base_w;           // inverse depth that w counts from, 1/m
uniform int channel;            // the layer's channel of w
uniform int slice;              // its slice of the radiance
uniform bool by_quads;          // light the quads, or the pixels
uniform uint first_number;      // of those of this dispatch
uniform uint end_number;        // one past their last
uniform vec3 eye;               // m
uniform vec3 far;               // w, depth and z of the far plane where the camera stands far back (drawing_space.py); else 0
uniform mat2 slope_per_px;      // change of a ray's slope from pixel to pixel: right and up per metre ahead
uniform vec2 first_slope;       // slope at the corner

void main()
{
    uint number = first_number + (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
    if (number >= end_number) return;
    uint place = places[by_quads ? int(number) : places.length() - 1 - int(number)];
    ivec2 first = ivec2(place & 0xffffu, place >> 16);
    int count = by_quads ? 4 : 1;
    float w = 0.0;
    Reflector mean = Reflector(vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0, vec3(0.0));
    for (int i = 0; i < count; ++i) {
        ivec2 pixel = first + ivec2(i & 1, i >> 1);
        Reflector s = reflector_at(pixel);
        w += abs(texelFetch(w_map, pixel, 0)[channel]);
        mean.f0 += s.f0;
        mean.normal += s.normal;
        mean.roughness += s.roughness;
        mean.occlusion += s.occlusion;
        mean.clearcoat += s.clearcoat;
        mean.clearcoat_roughness += s.clearcoat_roughness;
    }
    float share = 1.0 / float(count);
    w *= share;
    mean = Reflector(vec3(0.0), share * mean.f0, share * mean.roughness, share * mean.occlusion, share * mean.clearcoat,
                     share * mean.clearcoat_roughness, normalize(mean.normal));
    vec2 centre = vec2(first) + (by_quads ? 1.0 : 0.5);
    float depth = 1.0 / (w + base_w);
    float z = far.y > 0.0 ? far.z + (w - far.x) * depth * far.y : -depth;
    vec3 p = vec3((first_slope + slope_per_px * centre) * depth + eye.xy, z);
#ifdef LINKED
    unlit_by = links.unlit[min(link_set_at(first), uint(LINK_SETS - 1))];
#endif
    Reflected light = reflected_light(mean, p, normalize(eye - p));
    for (int i = 0; i < count; ++i) {
        ivec3 pixel = ivec3(first + ivec2(i & 1, i >> 1), slice);
        vec4 own = imageLoad(radiance, pixel);
        if (own.a <= 0.0) continue;  // a holdout
        vec4 albedo = texelFetch(albedo_roughness, pixel.xy, 0);
        vec3 sum = own.rgb + albedo.rgb * light.diffuse + light.specular * (albedo.a < 0.0 ? 1.0 / own.a : 1.0);
        if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);  // invalid light counts as none
        imageStore(radiance, pixel, vec4(min(sum, vec3(MAX_HALF)), own.a));
    }
}
