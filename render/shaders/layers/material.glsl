// UsdPreviewSurface inputs at a fragment.
// HAS_<INPUT> is defined for inputs that are read from a texture; their look-up is at LOOKUP_<INPUT> in `lookups`, and MAP_<INPUT> is
// the kind of its sampler: one image, or an array of UDIM tiles, of which there are any where TILED is defined. PLACE_<INPUT> are its
// texture coordinates. FROM_<INPUT> is defined for inputs that are further numbers of the vertices, of which it is the first.

#include "layers/fragment_w.glsl"

struct Surface {
    vec3 base_color;
    vec3 emissive;
    vec3 f0;             // reflectance at normal incidence
    float metallic;      // 1 has no diffuse response
    float roughness;
    float opacity;
    float occlusion;     // 1 sees the whole dome
    float clearcoat;
    float clearcoat_roughness;
    bool is_glass;       // opacity fades the diffuse response alone
    vec3 normal;         // camera space, towards the viewer's side
};

// Image look-up: rows 0 and 1 hold the 2x3 texture-coordinate transform, 2 the scale, 3 the bias; the last number of
// row 0 is the channel of a scalar input. Of a set of UDIM tiles, `fallback` shows where there is none, and `tiles` has a bit for each.
struct Lookup {
    vec4 rows[4];
    vec4 fallback;
    uvec4 tiles;
};

#ifndef GRAPH
layout(std140, binding = 1) uniform MaterialBlock {
    vec4 base_color_opacity;
    vec4 emissive_metallic;
    vec4 specular_workflow;          // rgb reflectance, a = 1 where it is used
    vec4 roughness_ior_threshold;    // roughness, ior, opacity threshold, whether display colour multiplies
    vec4 clearcoat_occlusion_glass;  // clear coat's amount and roughness, occlusion, whether opacity fades the diffuse response alone
    Lookup lookups[11];
} material;
#endif

uniform float eye_z;       // of the eye in the space of positions, m: 0 but for a camera that stands far back
uniform bool double_sided; // turn the normals of back faces towards the eye
uniform float detail;      // times finer than this pass's pixels that the finished picture samples surfaces
uniform float patch_px_m;  // side of one ray's patch per 1/m of w from the plane of focus (surface_sampling.py)
uniform vec3 focus;        // w of that plane at the pass's corner and its change along x and y

#ifdef HAS_BASE_COLOR
uniform MAP_BASE_COLOR base_color_map;
#endif
#ifdef HAS_EMISSIVE
uniform MAP_EMISSIVE emissive_map;
#endif
#ifdef HAS_METALLIC
uniform MAP_METALLIC metallic_map;
#endif
#ifdef HAS_ROUGHNESS
uniform MAP_ROUGHNESS roughness_map;
#endif
#ifdef HAS_SPECULAR
uniform MAP_SPECULAR specular_map;
#endif
#ifdef HAS_OPACITY
uniform MAP_OPACITY opacity_map;
#endif
#ifdef HAS_NORMAL
uniform MAP_NORMAL normal_map;
#endif
#ifdef HAS_OCCLUSION
uniform MAP_OCCLUSION occlusion_map;
#endif
#ifdef HAS_CLEARCOAT
uniform MAP_CLEARCOAT clearcoat_map;
#endif
#ifdef HAS_CLEARCOAT_ROUGHNESS
uniform MAP_CLEARCOAT_ROUGHNESS clearcoat_roughness_map;
#endif
#ifdef HAS_IOR
uniform MAP_IOR ior_map;
#endif

#ifdef VALUES_0_LOC
in vec4 frag_values_0;
in vec2 frag_values_1;
#endif

// Further number of the vertices, 0 where there are none.
float value_at(int i)
{
#ifdef VALUES_0_LOC
    return i < 4 ? frag_values_0[i] : frag_values_1[i - 4];
#else
    return 0.0;
#endif
}

vec2 value_pair(int i)
{
    return vec2(value_at(i), value_at(i + 1));
}

vec3 value_color(int i)
{
    return vec3(value_at(i), value_at(i + 1), value_at(i + 2));
}

vec2 lookup_uv(Lookup l, vec2 uv)
{
    vec3 st = vec3(uv, 1.0);
    return vec2(dot(l.rows[0].xyz, st), dot(l.rows[1].xyz, st));
}

vec4 lookup(Lookup l, sampler2D map, vec2 uv, float bias)
{
    vec2 st = lookup_uv(l, uv);
    return texture(map, vec2(st.x, 1.0 - st.y), bias) * l.rows[2] + l.rows[3];  // images have row 0 at the top
}

// Mip levels to the footprint of one ray of the finished picture, around this pixel.
float ray_bias()
{
    float patch_px = patch_px_m * (fragment_w() - focus.x - dot(focus.yz, gl_FragCoord.xy));
    return 0.5 * log2(patch_px * patch_px + 1.0 / (detail * detail));
}

vec4 lookup_color(Lookup l, sampler2D map, vec2 uv)
{
    return lookup(l, map, uv, ray_bias());
}

float lookup_scalar(Lookup l, sampler2D map, vec2 uv)
{
    return lookup_color(l, map, uv)[int(l.rows[0].w)];
}

#ifdef TILED
// Layer of a UDIM tile in its array, -1 for none. Tiles are ten to a row, and the array holds those that are there (render/model/udim.py).
float layer_of(uvec4 tiles, vec2 tile)
{
    if (!(tile.x >= 0.0 && tile.x < 10.0 && tile.y >= 0.0 && tile.y < 10.0)) return -1.0;
    uint number = uint(tile.x) + 10u * uint(tile.y), word = number >> 5, bit = 1u << (number & 31u);
    if ((tiles[word] & bit) == 0u) return -1.0;
    int before = bitCount(tiles[word] & (bit - 1u));
    for (uint i = 0u; i < word; ++i) before += bitCount(tiles[i]);
    return float(before);
}

vec4 lookup(Lookup l, sampler2DArray map, vec2 uv, float bias)
{
    vec2 st = lookup_uv(l, uv), tile = floor(st);
    vec2 dx = exp2(bias) * dFdx(st), dy = exp2(bias) * dFdy(st);  // not of the place in the tile, which jumps
    float layer = layer_of(l.tiles, tile);
    if (layer < 0.0) {  // interpolation may step over the upper end of a tile
        tile = floor(st - 1e-5);
        layer = layer_of(l.tiles, tile);
    }
    vec2 within = st - tile;
    vec4 texel = textureGrad(map, vec3(within.x, 1.0 - within.y, max(layer, 0.0)), vec2(dx.x, -dx.y), vec2(dy.x, -dy.y));
    return layer < 0.0 ? l.fallback : texel * l.rows[2] + l.rows[3];
}

vec4 lookup_color(Lookup l, sampler2DArray map, vec2 uv)
{
    return lookup(l, map, uv, ray_bias());
}

float lookup_scalar(Lookup l, sampler2DArray map, vec2 uv)
{
    return lookup_color(l, map, uv)[int(l.rows[0].w)];
}
#endif

#ifdef HAS_NORMAL
// Tangent frame from screen derivatives (Mikkelsen 2020, "Surface gradient-based bump mapping", section 3.3).
vec3 mapped_normal(vec3 tangent_normal, vec3 n, vec3 p, vec2 uv)
{
    vec3 dpx = dFdx(p), dpy = dFdy(p);
    vec2 dux = dFdx(uv), duy = dFdy(uv);
    vec3 r1 = cross(dpy, n), r2 = cross(n, dpx);
    vec3 t = r1 * dux.x + r2 * duy.x;
    vec3 b = r1 * dux.y + r2 * duy.y;
    float scale = inversesqrt(max(max(dot(t, t), dot(b, b)), 1e-30));
    // dot(dpx, r1) is negative where the picture mirrors the surface's handedness: keep t and b right-handed with it
    float flip = dot(dpx, r1) < 0.0 ? -1.0 : 1.0;
    return normalize(flip * scale * (t * tangent_normal.x + b * tangent_normal.y) + n * tangent_normal.z);
}
#endif

// Normals that vary within a sample blur the highlight by their variance, so that it does not sparkle: between pixels
// by Tokuyoshi & Kaplanyan 2019 ("Improved geometric specular antialiasing", section 3.1, sigma² = 1/4, kappa = 0.18), within
// a texel of the normal map by the length of its averaged normal (Toksvig 2005, "Mipmapping normal maps").
float filtered_roughness(float roughness, vec3 n, float shortening)
{
    vec3 dx = dFdx(n) / detail, dy = dFdy(n) / detail;
    float kernel = min(0.5 * (dot(dx, dx) + dot(dy, dy)), 0.18) + min(2.0 * shortening, 0.18);
    float alpha = roughness * roughness;
    return sqrt(sqrt(min(alpha * alpha + kernel, 1.0)));
}

// Unit normal; turned towards the eye on back faces of what is double-sided. One of length 0, as of a flattened instance, is
// replaced by the triangle's own.
vec3 facing_normal(vec3 position, vec3 normal, bool front)
{
    vec3 facet = cross(dFdx(position), dFdy(position));
    facet = dot(facet, position - vec3(0.0, 0.0, eye_z)) > 0.0 ? -facet : facet;
    vec3 n = dot(normal, normal) > 1e-20 ? normalize(normal) : (front ? 1.0 : -1.0) * facet * inversesqrt(max(dot(facet, facet), 1e-30));
    return front || !double_sided ? n : -n;
}

#ifdef GRAPH
#include "layers/graph.glsl"
#else
Surface evaluate_material(vec2 uv, vec4 color, vec3 position, vec3 normal, bool front)
{
    Surface s;
    vec4 display = mix(vec4(1.0), color, material.roughness_ior_threshold.w);
    s.base_color = material.base_color_opacity.rgb;
    s.opacity = material.base_color_opacity.a;
    s.emissive = material.emissive_metallic.rgb;
    s.metallic = material.emissive_metallic.a;
    s.roughness = material.roughness_ior_threshold.x;
    vec3 specular = material.specular_workflow.rgb;
    s.occlusion = material.clearcoat_occlusion_glass.z;
    s.clearcoat = material.clearcoat_occlusion_glass.x;
    s.clearcoat_roughness = material.clearcoat_occlusion_glass.y;
    s.is_glass = material.clearcoat_occlusion_glass.w > 0.5;
    float ior = material.roughness_ior_threshold.y;
#ifdef FROM_EMISSIVE
    s.emissive = value_color(FROM_EMISSIVE);
#endif
#ifdef FROM_METALLIC
    s.metallic = value_at(FROM_METALLIC);
#endif
#ifdef FROM_ROUGHNESS
    s.roughness = value_at(FROM_ROUGHNESS);
#endif
#ifdef FROM_SPECULAR
    specular = value_color(FROM_SPECULAR);
#endif
#ifdef FROM_OCCLUSION
    s.occlusion = value_at(FROM_OCCLUSION);
#endif
#ifdef FROM_CLEARCOAT
    s.clearcoat = value_at(FROM_CLEARCOAT);
#endif
#ifdef FROM_CLEARCOAT_ROUGHNESS
    s.clearcoat_roughness = value_at(FROM_CLEARCOAT_ROUGHNESS);
#endif
#ifdef FROM_IOR
    ior = value_at(FROM_IOR);
#endif
#ifdef HAS_BASE_COLOR
    s.base_color = lookup_color(material.lookups[LOOKUP_BASE_COLOR], base_color_map, PLACE_BASE_COLOR).rgb;
#endif
#ifdef HAS_EMISSIVE
    s.emissive = lookup_color(material.lookups[LOOKUP_EMISSIVE], emissive_map, PLACE_EMISSIVE).rgb;
#endif
#ifdef HAS_METALLIC
    s.metallic = lookup_scalar(material.lookups[LOOKUP_METALLIC], metallic_map, PLACE_METALLIC);
#endif
#ifdef HAS_ROUGHNESS
    s.roughness = lookup_scalar(material.lookups[LOOKUP_ROUGHNESS], roughness_map, PLACE_ROUGHNESS);
#endif
#ifdef HAS_SPECULAR
    specular = lookup_color(material.lookups[LOOKUP_SPECULAR], specular_map, PLACE_SPECULAR).rgb;
#endif
#ifdef HAS_OPACITY
    Lookup cut_out = material.lookups[LOOKUP_OPACITY];  // cut-outs keep their edges
    s.opacity = lookup(cut_out, opacity_map, PLACE_OPACITY, -log2(detail))[int(cut_out.rows[0].w)];
#endif
#ifdef HAS_OCCLUSION
    s.occlusion = lookup_scalar(material.lookups[LOOKUP_OCCLUSION], occlusion_map, PLACE_OCCLUSION);
#endif
#ifdef HAS_CLEARCOAT
    s.clearcoat = lookup_scalar(material.lookups[LOOKUP_CLEARCOAT], clearcoat_map, PLACE_CLEARCOAT);
#endif
#ifdef HAS_CLEARCOAT_ROUGHNESS
    s.clearcoat_roughness = lookup_scalar(material.lookups[LOOKUP_CLEARCOAT_ROUGHNESS], clearcoat_roughness_map, PLACE_CLEARCOAT_ROUGHNESS);
#endif
#ifdef HAS_IOR
    ior = lookup_scalar(material.lookups[LOOKUP_IOR], ior_map, PLACE_IOR);
#endif
    s.base_color *= display.rgb;
    s.opacity = clamp(s.opacity * display.a, 0.0, 1.0);
    float threshold = material.roughness_ior_threshold.z;
    if (threshold > 0.0) s.opacity = s.opacity >= threshold ? 1.0 : 0.0;

    float r = (1.0 - ior) / (1.0 + ior);
    if (material.specular_workflow.a > 0.5) {
        s.f0 = specular;
        s.metallic = 0.0;
    } else {
        s.metallic = clamp(s.metallic, 0.0, 1.0);
        s.f0 = mix(vec3(r * r), s.base_color, s.metallic);
    }
    float shortening = 0.0;
    s.normal = facing_normal(position, normal, front);
#ifdef HAS_NORMAL
    vec3 tangent = lookup_color(material.lookups[LOOKUP_NORMAL], normal_map, PLACE_NORMAL).xyz;
    shortening = max(1.0 - length(tangent), 0.0);
    bool is_mapped = dot(tangent, tangent) > 1e-12;
    vec3 mapped = mapped_normal(is_mapped ? normalize(tangent) : vec3(0.0, 0.0, 1.0), s.normal, position,
                                lookup_uv(material.lookups[LOOKUP_NORMAL], PLACE_NORMAL));  // outside the branch: it takes derivatives
    if (is_mapped) s.normal = mapped;
#endif
    s.roughness = filtered_roughness(clamp(s.roughness, 0.03, 1.0), s.normal, shortening);  // highlights of roughness 0 have no size
    s.clearcoat_roughness = filtered_roughness(clamp(s.clearcoat_roughness, 0.03, 1.0), s.normal, shortening);
    return s;
}
#endif
