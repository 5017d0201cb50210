// Filters of lights (render/layers/light_filters.py): barn doors and ramps by distance.
// The window of barn doors with a place of their own fades over its edges as in Barzel 1997, "Lighting controls for computer
// cinematography". Without one, as much of the light is seen as its outline has in the window: exact for a rect along the window's
// sides, and for a disk or a ball at one of them.

struct LightFilter {
    mat4 filter_from_camera;    // to the filter's own units
    vec4 effect;                // density, below 0 where it is inverted; multiplier; share of the effect on diffuse light and on highlights
    vec4 shape;                 // 0 barn doors: light before them (0 all, 1 the cone, 2 none), and 10 where they have no source; radii.
                                // Ramp by distance: 1 from the light, 2 along -Z, 3 from the origin, 4 from the Z axis; its begin and end
    vec4 sides;                 // of the window, along -X +X -Y +Y
    vec4 edges;
    vec4 source;                // of barn doors: a place (w = 1) or a direction (w = 0)
    vec4 outline;               // half the light's size along its X and Y, or its radius (m; distant: tangent of its half angle), and
                                // its outline: 1 a ball, 2 a disk, 3 a rect, 4 a tube
    vec4 ramp[RAMP_STEPS];
};

layout(std140, binding = 5) uniform FilterBlock { LightFilter filters[MAX_FILTERS]; } light_filters;

// Share that a window with soft edges lets through.
float window_share(LightFilter f, vec2 q)
{
    vec2 middle = 0.5 * vec2(f.sides.y - f.sides.x, f.sides.w - f.sides.z);
    bvec2 upper = greaterThan(q, middle);
    vec2 side = vec2(upper.x ? f.sides.y : f.sides.x, upper.y ? f.sides.w : f.sides.z);
    vec2 edge = vec2(upper.x ? f.edges.y : f.edges.x, upper.y ? f.edges.w : f.edges.z);
    vec2 radii = f.shape.zw;
    vec2 beyond = max(vec2(upper.x ? q.x : -q.x, upper.y ? q.y : -q.y) - (side - radii), vec2(0.0));
    float from_inner = length(beyond / radii), from_outer = length(beyond / (radii + edge));
    float along = from_outer * (from_inner - 1.0) / max(from_inner - from_outer, 1e-9);
    return from_inner <= 1.0 ? 1.0 : 1.0 - smoothstep(0.0, 1.0, along);
}

// Share of a light's outline, from -1 to 1, that lies below a place: of a rect's side, or of a disk.
float share_below(float at, bool is_round)
{
    float x = clamp(at, -1.0, 1.0);
    return is_round ? 0.5 + (x * sqrt(1.0 - x * x) + asin(x)) / PI : 0.5 + 0.5 * x;
}

// Share of a light that is seen through a window; half its outline's size there, along X and Y.
float seen_share(LightFilter f, vec2 q, vec2 half_size, bool is_round)
{
    vec2 size = max(half_size, vec2(1e-6) * (f.sides.yw + f.sides.xz) + 1e-12);
    vec4 at = vec4((f.sides.x + q.x) / size.x, (f.sides.y - q.x) / size.x, (f.sides.z + q.y) / size.y, (f.sides.w - q.y) / size.y);
    vec2 across = vec2(share_below(at.x, is_round) + share_below(at.y, is_round), share_below(at.z, is_round) + share_below(at.w, is_round));
    across = max(across - 1.0, 0.0);
    // a round corner, as far as the outline is small before it
    vec2 middle = 0.5 * vec2(f.sides.y - f.sides.x, f.sides.w - f.sides.z), radii = f.shape.zw;
    vec2 side = 0.5 * vec2(f.sides.y + f.sides.x, f.sides.w + f.sides.z);
    vec2 beyond = abs(q - middle) - (side - radii);
    if (min(beyond.x, beyond.y) <= 0.0) return across.x * across.y;
    vec2 outward = beyond / (radii * radii);
    float inside = (1.0 - length(beyond / radii)) * length(beyond / radii) / length(outward);
    float reach = is_round ? length(normalize(outward) * size) : dot(abs(normalize(outward)), size);
    return min(across.x * across.y, share_below(inside / reach, is_round));
}

float barn_share(LightFilter f, Light light, vec3 p, vec3 at)
{
    bool is_own = f.shape.y < 9.5;
    float before = f.shape.y - (is_own ? 0.0 : 10.0);
    bool is_distant = light.position_kind.w < 0.5;
    vec4 source = f.source;
    if (!is_own) source = f.filter_from_camera * (is_distant ? vec4(-light.axis_radius.xyz, 0.0) : vec4(light.position_kind.xyz, 1.0));
    vec3 towards = source.xyz - source.w * at;
    bool is_before = at.z > 0.0, is_through = is_own || source.z > 0.0;
    if (is_before && is_through && before != 1.0) return before > 1.5 ? 0.0 : 1.0;
    if (!is_before && !is_through) return 1.0;      // the light and the place are both beyond
    if (is_own && towards.z <= 0.0) return 0.0;     // the place is behind the source
    if (abs(towards.z) < 1e-9) return 1.0;
    float way = -at.z / towards.z;                  // to the window, from the place (0) towards the light (1)
    vec2 q = at.xy + way * towards.xy;
    if (is_own) return window_share(f, q);
    mat3 turn = mat3(f.filter_from_camera);
    vec3 x = turn * light.tube_focus.xyz, y = turn * cross(light.tube_focus.xyz, light.axis_radius.xyz);
    bool is_rect = f.outline.z > 2.5 && f.outline.z < 3.5;
    vec2 half_size = vec2(f.outline.y * length(turn[0]));
    if (is_rect) half_size = abs(f.outline.x * x.xy) + abs(f.outline.y * y.xy);
    if (f.outline.z > 3.5) half_size += abs(x.xy);
    return seen_share(f, q, abs(way) * half_size, !is_rect);
}

vec3 ramp_color(LightFilter f, Light light, vec3 p, vec3 at)
{
    float away = length(at.xy);
    if (f.shape.x < 3.5) away = length(at);
    if (f.shape.x < 2.5) away = -at.z;
    if (f.shape.x < 1.5) away = light.position_kind.w < 0.5 ? 1e9 : length(light.position_kind.xyz - p);
    float step_at = clamp((away - f.shape.z) / max(f.shape.w - f.shape.z, 1e-9), 0.0, 1.0) * float(RAMP_STEPS - 1);
    int first = min(int(step_at), RAMP_STEPS - 2);
    return mix(f.ramp[first].rgb, f.ramp[first + 1].rgb, step_at - float(first));
}

// What filters leave of a light at a place.
Reflected filtered(Light light, Reflected whole, vec3 p)
{
    int first = int(light.shadow_color.w), last = first + int(light.shadow_origin.w);
    for (int i = first; i < last; ++i) {
        LightFilter f = light_filters.filters[i];
        vec3 at = (f.filter_from_camera * vec4(p, 1.0)).xyz;
        vec3 share = f.shape.x > 0.5 ? ramp_color(f, light, p, at) : vec3(barn_share(f, light, p, at));
        if (f.effect.x < 0.0) share = 1.0 - share;
        share = mix(vec3(1.0), share, abs(f.effect.x)) * f.effect.y;
        whole.diffuse *= mix(vec3(1.0), share, f.effect.z);
        whole.specular *= mix(vec3(1.0), share, f.effect.w);
    }
    return whole;
}
