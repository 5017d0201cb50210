#version 450 core
// List what is lit of a layer: quads of 2x2 pixels whose surfaces are alike, and single pixels.
// in:  w of the layer, and its surfaces as the colour pass leaves them (surface.frag)
// out: numbers of quads and of pixels, and their places, x in the lower half: quads from the front, pixels from the back, in any order
// Light that varies less than a quad needs no four samples (He et al. 2014, "Extending the graphics pipeline with adaptive,
// multi-rate shading"). Texture of the albedo is kept: it multiplies what is shared.

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) buffer Listed { uint quads; uint pixels; uint places[]; };

uniform sampler2D w_map;
uniform int channel;            // the layer's channel of w
uniform ivec2 rows;             // first row that is listed, and one past the last
uniform bool by_quads;          // false lists single pixels alone
uniform float slope_per_px;     // angle between the rays of neighbouring pixels

#include "layers/stored_reflector.glsl"

const float ALIKE_NORMALS = 0.1;    // deviation of normals from the mean, and angle of a pixel, relative to the width of the lobe
const float ALIKE_W = 0.01;         // relative difference
const float ALIKE_ROUGHNESS = 0.05;
const float ALIKE_REFLECTANCE = 0.02;

bool are_alike(Reflector s[4], vec4 w)
{
    float nearest = max(max(w.x, w.y), max(w.z, w.w)), farthest = min(min(w.x, w.y), min(w.z, w.w));
    if (nearest - farthest > ALIKE_W * nearest) return false;
    vec3 normal = normalize(s[0].normal + s[1].normal + s[2].normal + s[3].normal);
    bool alike = true;
    for (int i = 0; i < 4; ++i) {
        vec3 off = s[i].normal - normal, f0 = abs(s[i].f0 - s[0].f0);
        float lobe = ALIKE_NORMALS * s[i].roughness * s[i].roughness;
        if (s[i].clearcoat > 0.0) lobe *= min(1.0, s[i].clearcoat_roughness / s[i].roughness);
        float unlike = max(abs(s[i].roughness - s[0].roughness), abs(s[i].clearcoat_roughness - s[0].clearcoat_roughness));
        unlike = max(unlike, max(abs(s[i].clearcoat - s[0].clearcoat), abs(s[i].occlusion - s[0].occlusion)));
        alike = alike && dot(off, off) <= lobe * lobe && slope_per_px <= lobe && unlike <= ALIKE_ROUGHNESS;
        alike = alike && max(f0.r, max(f0.g, f0.b)) <= ALIKE_REFLECTANCE;
    }
    return alike;
}

void main()
{
    ivec2 first = 2 * ivec2(gl_GlobalInvocationID.xy) + ivec2(0, rows.x), size = ivec2(textureSize(w_map, 0).x, rows.y);
    vec4 w;
    Reflector s[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 pixel = first + ivec2(i & 1, i >> 1), inside = min(pixel, size - 1);
        w[i] = pixel == inside ? abs(texelFetch(w_map, inside, 0)[channel]) : 0.0;
        s[i] = reflector_at(inside);
        if (s[i].roughness == 0.0) w[i] = 0.0;  // shows its own light alone (surface.frag)
    }
    if (w == vec4(0.0)) return;
    bool are_linked_alike = true;
#ifdef LINKED
    for (int i = 1; i < 4; ++i) {
        are_linked_alike = are_linked_alike
            && link_set_at(min(first + ivec2(i & 1, i >> 1), size - 1)) == link_set_at(first);
    }
#endif
    if (are_linked_alike && by_quads && all(greaterThan(w, vec4(0.0))) && are_alike(s, w)) {
        places[atomicAdd(quads, 1u)] = uint(first.x) | uint(first.y) << 16;
        return;
    }
    for (int i = 0; i < 4; ++i) {
        ivec2 pixel = first + ivec2(i & 1, i >> 1);
        if (w[i] > 0.0) places[places.length() - 1 - int(atomicAdd(pixels, 1u))] = uint(pixel.x) | uint(pixel.y) << 16;
    }
}
