// Light that a surface (reflector.glsl) sends to the eye: UsdLux lights by their irradiance, and the dome.
// All in camera space, metres; radiance scene-linear. Area lights are lit from their centre, with the exact irradiance
// of a sphere above the horizon and of a disk on its axis; their apparent size widens the highlight, whose energy stays. Tubes are
// in tube.glsl.

#define PI 3.14159265358979

struct Light {
    vec4 position_kind;     // xyz, 0 distant 1 sphere 2 disk or rect 3 tube
    vec4 axis_radius;       // direction of its light, and the radius of the disk of equal area (distant: sine of its half angle; tube: its own)
    vec4 radiance_area;     // radiance (distant: irradiance), area
    vec4 cone_response;     // outer and inner angle of the cone, diffuse and specular multiplier
    vec4 shadow;            // first shadow map or -1, number of maps, bias towards the light (m), texel size at 1 m (m)
    vec4 tube_focus;        // half a tube along its axis (m), of others the X axis; exponent of the focus
    vec4 focus_tint;        // colour that the focus leaves off the axis; number of the profile, 0 for none
    vec4 shadow_color;      // share of its light that shadows keep; its first filter
    vec4 shadow_origin;     // place that its shadow maps are seen from; number of its filters
    vec4 extent;            // half its size along X and Y, or its radius (m; distant: tangent of its half angle); its outline: 0 a point,
                            // 1 a ball, 2 a disk, 3 a rect, 4 a tube; with shadows: number of rows of its light, in the first of them
    vec4 soft;              // change of its shadow maps' depth to that of 1/distance (distant: of distance); farthest that shadows reach
                            // from casters, or -1; width of the zone within where they fade (m), and the exponent of that
};

layout(std140, binding = 2) uniform LightBlock {
    vec4 count;             // number of lights; 1 with a dome; rows of its image; number of lights with shadows (the first ones)
    vec4 dome_diffuse;      // multiplier of its irradiance
    mat4 dome_from_camera;
    mat4 world_from_camera;
    vec4 dome_radiance;
    Light lights[MAX_LIGHTS];
} lighting;

layout(binding = 9) uniform sampler2D dome_map;
layout(binding = 14) uniform sampler2D dome_irradiance;   // over pi, the first and last rows at the poles
#ifdef GLOSS_LEVELS
layout(binding = 15) uniform sampler2D dome_gloss;        // as rough mirrors see it: the last level of roughness 1, each before of 1/sqrt(2) of it
#endif

#ifdef LINKED
// Lights that leave a surface out: a bit for each light, and the last one for the dome.
layout(std140, binding = 4) uniform LinkBlock { uvec4 unlit[LINK_SETS]; } links;
uvec4 unlit_by = uvec4(0u);     // those of the surface that is lit
#endif

// Whether a light, or the dome as the last one, shines on the surface.
bool shines(int row)
{
#ifdef LINKED
    return (unlit_by[row >> 5] >> uint(row & 31) & 1u) == 0u;
#else
    return true;
#endif
}

#include "layers/shadow.glsl"
#include "layers/latlong.glsl"

vec3 fresnel(vec3 f0, float cosine)
{
    float x = 1.0 - cosine, x2 = x * x;  // multiplied out: a CPU rasteriser has no quick pow
    return f0 + (max(vec3(1.0), f0) - f0) * (x2 * x2 * x);
}

// GGX with the height-correlated Smith term (Heitz 2014). The half vectors of a light that reaches `spread` to each side (half
// its radius over its distance) blur the distribution of normals: their variances add.
float ggx(float nh, float nl, float nv, float alpha, float spread)
{
    float a2 = min(alpha * alpha + spread * spread, 1.0);
    float d = nh * nh * (a2 - 1.0) + 1.0;
    float distribution = a2 / (PI * d * d);
    float k2 = alpha * alpha;
    float v = nl * sqrt(nv * nv * (1.0 - k2) + k2) + nv * sqrt(nl * nl * (1.0 - k2) + k2);
    return distribution * 0.5 / max(v, 1e-4);
}

// Light that a surface sends to the eye: radiance is diffuse times the albedo, and specular.
struct Reflected {
    vec3 diffuse;
    vec3 specular;
};

Reflected brdf_times_cosine(Reflector s, vec3 v, vec3 l, float spread, vec2 response)
{
    float nl = max(dot(s.normal, l), 0.0);
    float nv = max(abs(dot(s.normal, v)), 1e-3);
    vec3 h = normalize(l + v);
    float nh = clamp(dot(s.normal, h), 0.0, 1.0), vh = clamp(dot(v, h), 0.0, 1.0);
    float alpha = s.roughness * s.roughness;
    vec3 f = fresnel(s.f0, vh);
    vec3 mirrored = f * ggx(nh, nl, nv, alpha, spread) * response.y;
#ifdef CLEARCOAT
    float coat = s.clearcoat_roughness * s.clearcoat_roughness + 1e-3;
    mirrored += s.clearcoat * fresnel(vec3(0.04), vh).r * ggx(nh, nl, nv, coat, spread) * response.y;
#endif
    return Reflected((nl / PI * response.x) * (1.0 - f), nl * mirrored);
}

#ifdef PROFILES
layout(binding = 11) uniform sampler2DArray profiles;  // by the angle around a light's axis and the angle from it
#endif

// Share of its light that a shaped light sends in a direction.
vec3 shaping(Light light, vec3 direction)
{
    vec3 share = vec3(1.0);
    float facing = dot(light.axis_radius.xyz, direction);
    float outer = light.cone_response.x, inner = light.cone_response.y;
    if (outer < PI) share *= 1.0 - smoothstep(inner, outer, acos(clamp(facing, -1.0, 1.0)));
#ifdef FOCUSED
    if (light.tube_focus.w > 0.0) share *= mix(light.focus_tint.rgb, vec3(1.0), pow(abs(facing), light.tube_focus.w));
#endif
#ifdef PROFILES
    if (light.focus_tint.w > 0.5) {
        vec3 x = normalize(light.tube_focus.xyz), y = cross(x, light.axis_radius.xyz);
        float around = atan(dot(direction, y), dot(direction, x)), away = acos(clamp(facing, -1.0, 1.0));
        float steps = float(textureSize(profiles, 0).y);
        vec3 place = vec3(around / (2.0 * PI), (away / PI * (steps - 1.0) + 0.5) / steps, light.focus_tint.w - 1.0);
        share *= textureLod(profiles, place, 0.0).r;
    }
#endif
    return share;
}

#ifdef TUBES
#include "layers/tube.glsl"
#endif

#ifdef FILTERED
#include "layers/light_filter.glsl"
#endif

Reflected whole_contribution(Light light, Reflector s, vec3 p, vec3 v)
{
#ifdef TUBES
    if (light.position_kind.w > 2.5) return tube_contribution(light, s, p, v);
#endif
    float spread;
    vec3 l, irradiance = light.radiance_area.rgb;
    if (light.position_kind.w < 0.5) {
        l = -light.axis_radius.xyz;
        spread = light.axis_radius.w * 0.5;
    } else {
        vec3 to_light = light.position_kind.xyz - p;
        float d2 = max(dot(to_light, to_light), 1e-8);
        float r = light.axis_radius.w;
        l = to_light * inversesqrt(d2);
        float facing = dot(light.axis_radius.xyz, -l);
        bool sphere = light.position_kind.w < 1.5;
        irradiance *= sphere ? PI * r * r / max(d2, r * r) : light.radiance_area.w * max(facing, 0.0) / (d2 + r * r);
        irradiance *= shaping(light, -l);
        spread = r * 0.5 * inversesqrt(d2);
    }
    Reflected share = brdf_times_cosine(s, v, l, spread, light.cone_response.zw);
    return Reflected(irradiance * share.diffuse, irradiance * share.specular);
}

Reflected light_contribution(Light light, Reflector s, vec3 p, vec3 v)
{
    Reflected whole = whole_contribution(light, s, p, v);
#ifdef FILTERED
    if (light.shadow_origin.w > 0.5) whole = filtered(light, whole, p);
#endif
    return whole;
}

vec3 dome_irradiance_over_pi(vec3 n)
{
    vec2 uv = latlong_uv(n);
    float rows = float(textureSize(dome_irradiance, 0).y);
    uv.y = (uv.y * (rows - 1.0) + 0.5) / rows;
    return lighting.dome_diffuse.rgb * textureLod(dome_irradiance, uv, 0.0).rgb;
}

// Reflectance of the whole hemisphere: Lazarov's fit of the split sum (Karis 2014, "Physically based shading on mobile").
vec3 environment_reflectance(vec3 f0, float roughness, float nv)
{
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * nv)) * r.x + r.y;
    vec2 ab = vec2(-1.04, 1.04) * a + r.zw;
    return max(f0 * ab.x + ab.y, vec3(0.0));
}

// Radiance of the dome's image about a direction, as a rough mirror sees it. Where it is smoother than the first level of roughness,
// a mip level of the image whose texels are as wide as the lobe.
vec3 dome_seen(vec3 direction, float roughness)
{
#ifdef GLOSS_LEVELS
    vec2 uv = latlong_uv(direction);
    float level = 2.0 * log2(max(roughness, 1e-3)) + float(GLOSS_LEVELS - 1);
    float lod = max(log2(0.82 * roughness * roughness * lighting.count.z), 0.0);
    vec3 smooth_one = textureLod(dome_map, uv, lod).rgb, rough_one = textureLod(dome_gloss, uv, max(level, 0.0)).rgb;
    return mix(smooth_one, rough_one, clamp(level + 1.0, 0.0, 1.0));
#else
    return vec3(1.0);
#endif
}

Reflected dome_contribution(Reflector s, vec3 v)
{
    mat3 dome = mat3(lighting.dome_from_camera);
    float nv = max(abs(dot(s.normal, v)), 1e-3);
    vec3 reflectance = environment_reflectance(s.f0, s.roughness, nv);
    vec3 mirror = normalize(dome * reflect(-v, s.normal));
    vec3 seen = lighting.dome_radiance.rgb * dome_seen(mirror, s.roughness);
    vec3 diffuse = (1.0 - reflectance) * dome_irradiance_over_pi(normalize(dome * s.normal));
    return Reflected(s.occlusion * diffuse, s.occlusion * reflectance * seen);
}

Reflected reflected_light(Reflector s, vec3 p, vec3 v)
{
    Reflected sum = Reflected(vec3(0.0), vec3(0.0));
    if (lighting.count.y > 0.5 && shines(127)) sum = dome_contribution(s, v);
    int n = int(lighting.count.x), shadowed = int(lighting.count.w);
    // two loops, since a CPU runs both sides of a branch: only lights with shadow maps pay for them
    for (int i = 0; i < shadowed;) {
        int rows = int(lighting.lights[i].extent.w);
        Reflected own = Reflected(vec3(0.0), vec3(0.0));
        bool is_lit = shines(i);
        for (int row = i; is_lit && row < i + rows; ++row) {
            Reflected part = light_contribution(lighting.lights[row], s, p, v);
            own = Reflected(own.diffuse + part.diffuse, own.specular + part.specular);
        }
        // what the light does not reach needs no shadow
        is_lit = is_lit && any(greaterThan(own.diffuse + own.specular, vec3(0.0)));
        for (int once = 0; is_lit && once < 1; ++once) {
            vec3 visible = mix(lighting.lights[i].shadow_color.rgb, vec3(1.0), shadow_visibility(i, p, s.normal));
            sum = Reflected(sum.diffuse + visible * own.diffuse, sum.specular + visible * own.specular);
        }
        i += rows;
    }
    for (int i = shadowed; i < n; ++i) {
        if (!shines(i)) continue;
        Reflected own = light_contribution(lighting.lights[i], s, p, v);
        sum = Reflected(sum.diffuse + own.diffuse, sum.specular + own.specular);
    }
    return sum;
}
