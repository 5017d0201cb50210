// Lobes of MaterialX that few surfaces have. Where GRAPH_SHEEN or GRAPH_FILM is not defined, they cost nothing.

float graph_facing(vec3 normal)
{
    vec3 n = dot(normal, normal) > 1e-12 ? normalize(normal) : graph_normal;
    return clamp(abs(dot(n, normalize(graph_eye - graph_position))), 1e-3, 1.0);
}

#ifdef GRAPH_SHEEN
// Share of light from all sides that a sheen reflects: of Estevez & Kulla 2017, "Production friendly microfacet sheen BRDF", by
// MaterialX's fit, or that of Zeltner, Burley & Chiang 2022, "Practical multiple-scattering sheen using linearly transformed cosines".
float sheen_reflectance(float nv, float roughness, bool is_fuzz)
{
    float x = nv, y = clamp(roughness, 0.01, 1.0);
    if (is_fuzz) {
        float s = y * (0.0206607 + 1.58491 * y) / (0.0379424 + y * (1.32227 + y));
        float m = y * (-0.193854 + y * (-1.14885 + y * (1.7932 - 0.95943 * y * y))) / (0.046391 + y);
        float o = y * (0.000654023 + (-0.0207818 + 0.119681 * y) * y) / (1.26264 + y * (-1.92021 + y));
        float away = (x - m) / s;
        return clamp(exp(-0.5 * away * away) / (s * sqrt(2.0 * 3.14159265)) + o, 0.0, 1.0);
    }
    vec2 r = vec2(13.673, 1.0) + vec2(-68.78018, 61.57746) * x + vec2(799.08825, 442.78211) * y
           + vec2(-905.00061, 2597.49308) * x * y + vec2(60.28956, 121.81241) * x * x + vec2(1086.96473, 3045.55075) * y * y;
    return clamp(r.x / r.y, 0.0, 1.0);
}

// Lay a sheen over `graph_surface`. It reflects what it reflects in all from every direction of light alike, as MaterialX has it for
// the sky; under lamps it lacks its own shape.
void add_sheen(vec3 color, float weight, float roughness, bool is_fuzz)
{
    if (weight <= 0.0) return;
    float all = weight * sheen_reflectance(graph_facing(graph_surface.normal), roughness, is_fuzz), rest = max(1.0 - all, 0.0);
#ifndef UNLIT
    graph_surface.base_color *= 1.0 - graph_surface.metallic;
    graph_surface.metallic = 0.0;
#endif
    graph_surface.base_color = rest * graph_surface.base_color + all * color;
    graph_surface.f0 *= rest;
    graph_transmission *= rest;
}
#else
#define add_sheen(color, weight, roughness, is_fuzz)
#endif

#ifdef GRAPH_FILM
// Interference of two orders of reflection (Belcour & Barla 2017, "A practical extension to microfacet theory for the modeling of varying
// iridescence"), as in Khronos' KHR_materials_iridescence.
vec3 film_sensitivity(float path_m, vec3 shift)
{
    float phase = 2.0 * 3.14159265 * path_m;
    vec3 width = vec3(4.3278e9, 9.3046e9, 6.6121e9);
    vec3 xyz = vec3(5.4856e-13, 4.4201e-13, 5.2481e-13) * sqrt(2.0 * 3.14159265 * width)
             * cos(vec3(1.6810e6, 1.7953e6, 2.2084e6) * phase + shift) * exp(-phase * phase * width);
    xyz.x += 9.7470e-14 * sqrt(2.0 * 3.14159265 * 4.5282e9) * cos(2.2399e6 * phase + shift.x) * exp(-4.5282e9 * phase * phase);
    xyz /= 1.0685e-7;
    return mat3(3.2404542, -0.9692660, 0.0556434, -1.5371385, 1.8760108, -0.2040259, -0.4985314, 0.0415560, 1.0572252) * xyz;
}

vec3 film_fresnel(vec3 f0, float cosine)
{
    float x = 1.0 - cosine, x2 = x * x;
    return f0 + (1.0 - f0) * (x2 * x2 * x);
}

// Reflectance at normal incidence with which Schlick's approximation gives, at this angle, that of a film on a surface.
vec3 under_film(vec3 f0, vec3 normal, float weight, float thickness_nm, float ior)
{
    if (weight <= 0.0 || thickness_nm <= 0.0) return f0;
    float nv = graph_facing(normal);
    float index = mix(1.0, max(ior, 1.0), smoothstep(0.0, 30.0, thickness_nm));
    float inside = sqrt(max(1.0 - (1.0 - nv * nv) / (index * index), 0.0));
    float first = film_fresnel(vec3(reflectance_of(index)), nv).x, through = 1.0 - first;
    vec3 root = sqrt(clamp(f0, 0.0, 0.9999)), below = (1.0 + root) / (1.0 - root), step_in = (below - index) / (below + index);
    vec3 second = film_fresnel(step_in * step_in, inside);
    vec3 shift = vec3(3.14159265) + mix(vec3(0.0), vec3(3.14159265), lessThan(below, vec3(index)));
    vec3 both = clamp(first * second, 1e-5, 0.9999);
    vec3 back = through * through * second / (1.0 - both);
    vec3 light = first + back, order = back - through;
    for (int m = 1; m <= 2; ++m) {
        order *= sqrt(both);
        light += order * 2.0 * film_sensitivity(float(m) * 2.0 * index * thickness_nm * 1e-9 * inside, float(m) * shift);
    }
    float x = min(1.0 - nv, 0.95), grazing = x * x * x * x * x;
    return mix(f0, clamp((light - grazing) / (1.0 - grazing), 0.0, 1.0), clamp(weight, 0.0, 1.0));
}
#else
#define under_film(f0, normal, weight, thickness_nm, ior) (f0)
#endif
