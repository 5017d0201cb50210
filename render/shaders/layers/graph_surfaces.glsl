// Surface shaders of MaterialX as the lobes that surfaces have here. Each sets `graph_surface`, linear Rec. 709, and returns its
// number among those that are mixed; render/stage/materials/mtlx/surfaces.py gives the order of the arguments.
// standard_surface: Georgiev et al. 2019, "Autodesk Standard Surface"; open_pbr_surface: Andersson et al. 2024, "OpenPBR".

float reflectance_of(float ior)
{
    float r = (1.0 - ior) / (1.0 + ior);
    return r * r;
}

#include "layers/graph_lobes.glsl"

// Amount of a clear coat of refractive index 1.5 that reflects as much.
float coat_of(float amount, float ior)
{
    return clamp(amount * reflectance_of(ior) / 0.04, 0.0, 1.0);
}

// What goes through does so by its mean, since surfaces have one opacity. What is kept back is shown as light that the body
// scatters.
vec3 let_through(float transmission, vec3 color, float metallic, vec3 diffuse)
{
    float mean = clamp(dot(color, vec3(1.0 / 3.0)), 0.0, 1.0);
    graph_transmission = transmission * mean * (1.0 - metallic);
    return (1.0 - transmission) * diffuse + transmission * (1.0 - mean) * color;
}

#ifdef GRAPH_MIXED
Surface mixed_surfaces[GRAPH_MIXED];
float mixed_transmissions[GRAPH_MIXED];
int mixed_count = 0;

// Keep `graph_surface` for the mix that it is a part of, and return its number.
float keep_surface()
{
    int at = min(mixed_count, GRAPH_MIXED - 1);
    mixed_surfaces[at] = graph_surface;
    mixed_transmissions[at] = graph_transmission;
    mixed_count = at + 1;
    return float(at);
}
#else
#define keep_surface() 0.0
#endif

void set_surface(vec3 base_color, float metallic, vec3 f0, float roughness, vec3 normal)
{
    graph_surface = plain_surface();
    graph_surface.base_color = base_color;
    graph_surface.metallic = clamp(metallic, 0.0, 1.0);
    graph_surface.f0 = f0;
    graph_surface.roughness = roughness;
    graph_surface.normal = normal;
}

void surface_standard_surface(
    float base, vec3 base_color, float metalness, float specular, vec3 specular_color, float specular_roughness,
    float specular_ior, float transmission, vec3 transmission_color, float subsurface, vec3 subsurface_color,
    float coat, vec3 coat_color, float coat_roughness, float coat_ior, float coat_affect_color, float emission,
    vec3 emission_color, vec3 opacity, vec3 normal, float sheen, vec3 sheen_color, float sheen_roughness, float film_nm,
    float film_ior, out float result)
{
    vec3 tint = mix(vec3(1.0), coat_color, coat);
    vec3 diffuse = mix(base * base_color, subsurface_color, subsurface);
    diffuse = pow(max(diffuse, 0.0), vec3(1.0 + clamp(coat, 0.0, 1.0) * coat_affect_color));
    vec3 f0 = mix(reflectance_of(specular_ior) * specular * specular_color, base * base_color, metalness);
    f0 = under_film(f0, normal, 1.0, film_nm, film_ior);
    diffuse = let_through(transmission, transmission_color, metalness, diffuse);
    set_surface(diffuse * tint, metalness, f0 * tint, specular_roughness, normal);
    add_sheen(sheen_color * tint, sheen * (1.0 - metalness), sheen_roughness, false);
    graph_surface.emissive = emission * emission_color * tint;
    graph_surface.clearcoat = coat_of(coat, coat_ior);
    graph_surface.clearcoat_roughness = coat_roughness;
    graph_surface.opacity = dot(opacity, vec3(1.0 / 3.0));
    result = keep_surface();
}

void surface_open_pbr_surface(
    float base_weight, vec3 base_color, float metalness, float specular_weight, vec3 specular_color,
    float specular_roughness, float specular_ior, float transmission, vec3 transmission_color, float subsurface,
    vec3 subsurface_color, float coat, vec3 coat_color, float coat_roughness, float coat_ior, float emission_luminance,
    vec3 emission_color, float opacity, vec3 normal, float fuzz, vec3 fuzz_color, float fuzz_roughness, float film,
    float film_um, float film_ior, out float result)
{
    vec3 tint = mix(vec3(1.0), coat_color, coat);
    vec3 base = base_weight * base_color, diffuse = mix(base, subsurface_color, subsurface);
    vec3 f0 = mix(reflectance_of(specular_ior) * specular_color, base, metalness) * specular_weight;
    f0 = under_film(f0, normal, film, 1000.0 * film_um, film_ior);
    diffuse = let_through(transmission, transmission_color, metalness, diffuse);
    set_surface(diffuse * tint, metalness, f0 * tint, specular_roughness, normal);
    add_sheen(fuzz_color, fuzz, fuzz_roughness, true);
    graph_surface.emissive = emission_luminance * emission_color * tint;
    graph_surface.clearcoat = coat_of(coat, coat_ior);
    graph_surface.clearcoat_roughness = coat_roughness;
    graph_surface.opacity = opacity;
    result = keep_surface();
}

void surface_gltf_pbr(
    vec3 base_color, float metallic, float roughness, vec3 normal, float occlusion, float transmission, float specular,
    vec3 specular_color, float ior, float alpha, int alpha_mode, float alpha_cutoff, float clearcoat,
    float clearcoat_roughness, vec3 emissive, float emissive_strength, vec3 sheen_color, float sheen_roughness,
    float iridescence, float iridescence_ior, float iridescence_nm, out float result)
{
    vec3 f0 = mix(min(reflectance_of(ior) * specular_color, 1.0) * specular, base_color, metallic);
    f0 = under_film(f0, normal, iridescence, iridescence_nm, iridescence_ior);
    set_surface(let_through(transmission, base_color, metallic, base_color), metallic, f0, roughness, normal);
    float sheen = max(sheen_color.r, max(sheen_color.g, sheen_color.b));
    add_sheen(sheen_color / max(sheen, 1e-6), sheen, sheen_roughness * sheen_roughness, false);
    graph_surface.occlusion = occlusion;
    graph_surface.emissive = emissive * emissive_strength;
    graph_surface.clearcoat = clearcoat;
    graph_surface.clearcoat_roughness = clearcoat_roughness;
    graph_surface.opacity = alpha_mode == 0 ? 1.0 : alpha_mode == 1 ? step(alpha_cutoff, alpha) : alpha;
    result = keep_surface();
}

void surface_UsdPreviewSurface(
    vec3 diffuse_color, vec3 emissive_color, int use_specular_workflow, vec3 specular_color, float metallic,
    float roughness, float clearcoat, float clearcoat_roughness, float opacity, int opacity_mode,
    float opacity_threshold, float ior, vec3 normal, float occlusion, out float result)
{
    float metal = use_specular_workflow == 1 ? 0.0 : clamp(metallic, 0.0, 1.0);
    vec3 f0 = use_specular_workflow == 1 ? specular_color : mix(vec3(reflectance_of(ior)), diffuse_color, metal);
    vec3 tangent = dot(normal, normal) > 1e-12 ? normal : vec3(0.0, 0.0, 1.0);
    normal = graph_tangent * tangent.x + graph_bitangent * tangent.y + graph_normal * tangent.z;
    graph_transmission = 0.0;
    set_surface(diffuse_color, metal, f0, roughness, normal);
    graph_surface.occlusion = occlusion;
    graph_surface.emissive = emissive_color;
    graph_surface.clearcoat = clearcoat;
    graph_surface.clearcoat_roughness = clearcoat_roughness;
    graph_surface.is_glass = opacity_mode == 0 && opacity_threshold <= 0.0;
    graph_surface.opacity = opacity_threshold > 0.0 ? step(opacity_threshold, opacity) : opacity;
    result = keep_surface();
}

// Burley 2012, "Physically based shading at Disney": specular 1 reflects 8 % at normal incidence.
void surface_disney_principled(
    vec3 base_color, float metallic, float roughness, float specular, float specular_tint, float clearcoat,
    float clearcoat_gloss, float transmission, float sheen, float sheen_tint, out float result)
{
    float luminance = dot(base_color, vec3(0.2126, 0.7152, 0.0722));
    vec3 tint = luminance > 0.0 ? base_color / luminance : vec3(1.0);
    vec3 f0 = mix(0.08 * specular * mix(vec3(1.0), tint, specular_tint), base_color, metallic);
    set_surface(let_through(transmission, base_color, metallic, base_color), metallic, f0, roughness, graph_normal);
    add_sheen(mix(vec3(1.0), base_color, sheen_tint), sheen * (1.0 - metallic), 0.3, false);
    graph_surface.clearcoat = 0.25 * clearcoat;
    graph_surface.clearcoat_roughness = sqrt(mix(0.1, 0.001, clearcoat_gloss));
    result = keep_surface();
}

void surface_surface_unlit(
    float emission, vec3 emission_color, float transmission, vec3 transmission_color, float opacity, out float result)
{
    set_surface(vec3(0.0), 0.0, vec3(0.0), 1.0, graph_normal);
    graph_surface.emissive = emission * emission_color;
    let_through(transmission, transmission_color, 0.0, vec3(0.0));
    graph_surface.opacity = opacity;
    result = keep_surface();
}

// Lobes that render/stage/materials/mtlx/lobes.py has made one of each kind.
void surface_surface(
    vec3 diffuse, vec3 f0, vec3 metal, float roughness, vec3 normal, float coat, float coat_roughness, vec3 through,
    float through_weight, vec3 emission, float opacity, vec3 sheen, float sheen_weight, float sheen_roughness, float is_fuzz,
    float film_nm, float film_ior, out float result)
{
    float kept_back = through_weight > 0.0 ? 1.0 - clamp(dot(through, vec3(1.0 / 3.0)) / through_weight, 0.0, 1.0) : 0.0;
    set_surface(diffuse + kept_back * through, 0.0, under_film(f0 + metal, normal, 1.0, film_nm, film_ior), roughness, normal);
#ifdef UNLIT
    graph_surface.base_color += metal;
#endif
    graph_transmission = dot(through, vec3(1.0 / 3.0));
    add_sheen(sheen / max(sheen_weight, 1e-6), sheen_weight, sheen_roughness, is_fuzz > 0.5);
    graph_surface.emissive = emission;
    graph_surface.clearcoat = coat;
    graph_surface.clearcoat_roughness = coat_roughness;
    graph_surface.opacity = opacity;
    result = keep_surface();
}

#ifdef GRAPH_MIXED
vec3 normal_of(Surface s)
{
    return dot(s.normal, s.normal) > 1e-12 ? normalize(s.normal) : graph_normal;
}

float most_of(vec3 color)
{
    return max(color.r, max(color.g, color.b));
}

float mean_of(vec3 color)
{
    return dot(color, vec3(1.0 / 3.0));
}

// Share of the second of two weights.
float second_share(float first, float second, float otherwise)
{
    return first + second > 0.0 ? second / (first + second) : otherwise;
}

// Mix of two surfaces. Light that they scatter, reflect, let through and emit is mixed; a side counts as far as it is opaque. A mix
// has one roughness, one normal and one occlusion, means by what each side sends back, and its coat lies on all of it.
void surface_mixed_surface(float bg, float fg, float share, out float result)
{
    int first = clamp(int(bg), 0, GRAPH_MIXED - 1), second = clamp(int(fg), 0, GRAPH_MIXED - 1);
    Surface a = mixed_surfaces[first], b = mixed_surfaces[second];
    float t = clamp(share, 0.0, 1.0);
    float a_opaque = (1.0 - t) * clamp(a.opacity, 0.0, 1.0), b_opaque = t * clamp(b.opacity, 0.0, 1.0);
    float opacity = a_opaque + b_opaque, body = second_share(a_opaque, b_opaque, t);
    // The opacity of glass does not fade what it reflects and emits.
    bool is_glass = (a.is_glass && t < 1.0) || (b.is_glass && t > 0.0);
    float a_shine = a.is_glass ? 1.0 - t : a_opaque, b_shine = b.is_glass ? t : b_opaque;
    if (!is_glass) {
        a_shine = 1.0 - body;
        b_shine = body;
    }
    vec3 f0 = a_shine * a.f0 + b_shine * b.f0;
#ifndef UNLIT
    // Lighting takes what the specular lobe reflects from the diffuse light, channel by channel of the working space.
    vec3 let_in = max(1.0 - in_working(f0), 1e-3);
    a.base_color = from_working(in_working(a.base_color) * (1.0 - in_working(a.f0)) / let_in) * (1.0 - a.metallic);
    b.base_color = from_working(in_working(b.base_color) * (1.0 - in_working(b.f0)) / let_in) * (1.0 - b.metallic);
    a.metallic = b.metallic = 0.0;
#endif
    float a_sent = (1.0 - body) * mean_of(a.base_color) + a_shine * mean_of(a.f0);
    float b_sent = body * mean_of(b.base_color) + b_shine * mean_of(b.f0);
    float sent = second_share(a_sent, b_sent, t);
    float shine = second_share(a_shine * mean_of(a.f0), b_shine * mean_of(b.f0), t);
    float coat = second_share(a_shine * a.clearcoat, b_shine * b.clearcoat, t);
    set_surface(mix(a.base_color, b.base_color, body), mix(a.metallic, b.metallic, body), f0, mix(a.roughness, b.roughness, shine),
                mix(normal_of(a), normal_of(b), sent));
    graph_surface.emissive = a_shine * a.emissive + b_shine * b.emissive;
    graph_surface.opacity = opacity;
    graph_surface.occlusion = mix(a.occlusion, b.occlusion, sent);
    graph_surface.clearcoat = a_shine * a.clearcoat + b_shine * b.clearcoat;
    graph_surface.clearcoat_roughness = mix(a.clearcoat_roughness, b.clearcoat_roughness, coat);
    graph_surface.is_glass = is_glass;
    // Only what is not reflected comes through.
    float a_through = mixed_transmissions[first] * (1.0 - most_of(in_working(a.f0)));
    float b_through = mixed_transmissions[second] * (1.0 - most_of(in_working(b.f0)));
    graph_transmission = mix(a_through, b_through, body) / max(1.0 - most_of(in_working(f0)), 1e-3);
    result = keep_surface();
}
#endif
