// Visibility of a light from a point, by shadow maps (one for a distant, disk, rect or spot light, six for one that
// shines all around).
// The maps hold reversed depth (1 near, 0 far). A light without size: four bilinear comparisons soften the edge over about two
// texels. One with a size: percentage-closer soft shadows (Fernando 2005), with the light's own outline as the kernel
// (soft_shadow.glsl).

layout(std140, binding = 3) uniform ShadowBlock {
    mat4 clip_from_camera[MAX_SHADOW_MAPS];
} shadows;

layout(binding = 10) uniform sampler2DArrayShadow shadow_maps;

int cube_face(vec3 d)  // the order of the maps of a sphere light: +X -X +Y -Y +Z -Z of camera-independent world axes
{
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z) return d.x > 0.0 ? 0 : 1;
    if (a.y >= a.z) return d.y > 0.0 ? 2 : 3;
    return d.z > 0.0 ? 4 : 5;
}

float hard_visibility(float map, vec3 at)
{
    vec2 uv = at.xy * 0.5 + 0.5, texel = 0.75 / vec2(textureSize(shadow_maps, 0).xy);
    float lit = 0.0;
    for (int i = 0; i < 4; ++i) {
        vec2 offset = vec2((i & 1) * 2 - 1, (i >> 1) * 2 - 1) * texel;
        lit += texture(shadow_maps, vec4(uv + offset, map, at.z));
    }
    return lit * 0.25;
}

#ifdef SOFT_SHADOWS
#include "layers/soft_shadow.glsl"
#endif

vec3 shadow_visibility(int row, vec3 p, vec3 n)
{
    Light light = lighting.lights[row];
    int map = int(light.shadow.x);
    bool distant = light.position_kind.w < 0.5;
    vec3 to_light = distant ? -light.axis_radius.xyz : light.shadow_origin.xyz - p;
    float distance_m = distant ? 1.0 : length(to_light);
    vec3 l = to_light / max(distance_m, 1e-6);
    // offset the point from its surface by the size of its texel, more at grazing light
    float texel_m = light.shadow.w * distance_m;
    p += n * texel_m * (1.0 + 2.0 * (1.0 - clamp(dot(n, l), 0.0, 1.0))) + l * light.shadow.z;
    if (light.shadow.y > 1.5) map += cube_face(mat3(lighting.world_from_camera) * (p - light.shadow_origin.xyz));
    vec4 clip = shadows.clip_from_camera[map] * vec4(p, 1.0);
    if (clip.w <= 0.0) return vec3(1.0);
    vec3 at = clip.xyz / clip.w;
    if (any(greaterThan(abs(at.xy), vec2(1.0))) || at.z <= 0.0) return vec3(1.0);
    vec3 visible = vec3(1.0);
#ifdef SOFT_SHADOWS
    bool is_soft = light.extent.z > 0.5;
#else
    const bool is_soft = false;
#endif
    // loops of one step: Mesa's CPU rasteriser runs both sides of a branch, and skips a loop that no pixel enters
    for (int once = 0; !is_soft && once < 1; ++once) visible = vec3(hard_visibility(float(map), at));
#ifdef SOFT_SHADOWS
    for (int once = 0; is_soft && once < 1; ++once) visible = vec3(soft_visibility(light, row, map, at, l, distance_m, clip.w));
#endif
    return visible;
}
