// Surface that light falls on, as the colour pass stores it for layers/shade.comp.

struct Reflector {
    vec3 albedo;         // of the diffuse response
    vec3 f0;             // reflectance at normal incidence
    float roughness;
    float occlusion;     // 1 sees the whole dome
    float clearcoat;
    float clearcoat_roughness;
    vec3 normal;         // camera space; away from the viewer on back faces of what is not double-sided
};

// Octahedral coordinates of a direction, 0 to 1 (Cigolle et al. 2014, "A survey of efficient representations for independent unit
// vectors").
vec2 octahedral(vec3 n)
{
    n /= abs(n.x) + abs(n.y) + abs(n.z);
    vec2 folded = (1.0 - abs(n.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(n.xy, vec2(0.0)));
    return 0.5 + 0.5 * (n.z >= 0.0 ? n.xy : folded);
}

vec3 direction_of(vec2 octahedral)
{
    vec2 p = 2.0 * octahedral - 1.0;
    float z = 1.0 - abs(p.x) - abs(p.y), fold = max(-z, 0.0);
    return normalize(vec3(p - fold * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(p, vec2(0.0))), z));
}
