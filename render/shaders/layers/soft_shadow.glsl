// Percentage-closer soft shadows (Fernando 2005, "Percentage-closer soft shadows"), with three changes:
// - A pyramid of the nearest casters (Guennebaud et al. 2006, "Real-time soft shadow mapping by backprojection") bounds the
//   search, so that what nothing hides is found in a few look-ups.
// - A caster counts in the mean alone if it hides the light: depths are affine in 1/distance (distant lights: in distance), so that
//   the light's outline, times the difference in depth, is what a caster must lie in. A receiver does not shade itself.
// - The kernel is the light's outline, projected: the share of the light that a straight edge at one depth leaves is right. It is
//   summed over all of its cells, texels or squares of them, in which a caster and what is behind it count by the mean depth. So
//   there is neither noise nor banding.

layout(binding = 12) uniform sampler2DArray shadow_depths;    // the maps, read without comparison
layout(binding = 13) uniform sampler2DArray shadow_cells;     // least, greatest and mean depth of 2x2, 4x4 ... texels

#ifdef COLORED_SHADOWS
#define Share vec3  // of each colour of a light with an image

// Mean colour of a rect's image in a cell of its outline, from -1 to 1 along X and Y, that is no larger than its parts. These are
// rows of the block from the light's own: from +Y down, and from +X in each line.
vec3 cell_color(int row, vec2 middle, vec2 size)
{
    int parts = int(lighting.lights[row].extent.w), across = int(sqrt(float(parts)) + 0.5);
    if (parts < 2 || lighting.lights[row].extent.z < 2.5 || lighting.lights[row].extent.z > 3.5) return vec3(1.0);
    vec2 place = (0.5 - 0.5 * middle) * float(across), border = floor(place + 0.5);
    vec2 beyond = clamp((place - border) / max(0.5 * size * float(across), 1e-6) + 0.5, 0.0, 1.0);
    ivec2 last = ivec2(across - 1), second = clamp(ivec2(border), ivec2(0), last), first = clamp(ivec2(border) - 1, ivec2(0), last);
    vec3 upper = mix(lighting.lights[row + first.y * across + first.x].radiance_area.rgb,
                     lighting.lights[row + first.y * across + second.x].radiance_area.rgb, beyond.x);
    vec3 lower = mix(lighting.lights[row + second.y * across + first.x].radiance_area.rgb,
                     lighting.lights[row + second.y * across + second.x].radiance_area.rgb, beyond.x);
    return mix(upper, lower, beyond.y);
}
#else
#define Share float
#endif

const int SEARCHED = 16;
const vec2 MOST_CELLS = vec2(2.5, 4.0);  // along half a kernel: of one that may have a caster at its edge, and of others

// Least and greatest depth in a rectangle around a place, and up to four times as far.
vec2 depth_range(int map, vec2 uv, vec2 reach)
{
    int side = textureSize(shadow_cells, 0).x, last_level = textureQueryLevels(shadow_cells) - 1;
    float across = 2.0 * max(reach.x, reach.y) * float(side);
    int level = int(clamp(ceil(log2(max(across, 1.0))), 0.0, float(last_level)));
    int cells = side >> level;  // textureSize of it: a CPU rasteriser takes that of one invocation for all
    ivec2 first = ivec2(floor(uv * float(cells) - 0.5));
    vec2 range = vec2(1.0, 0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 place = clamp(first + ivec2(i & 1, i >> 1), ivec2(0), ivec2(cells - 1));
        vec2 cell = texelFetch(shadow_cells, ivec3(place, map), level).rg;
        range = vec2(min(range.x, cell.x), max(range.y, cell.y));
    }
    return range;
}

// Half axes of the light's outline as seen from a point towards l, camera space, metres (a distant light's: of its angle).
void outline_axes(Light light, vec3 up, vec3 l, out vec3 a, out vec3 b)
{
    vec3 x = light.tube_focus.xyz;
    if (light.extent.z > 3.5) {         // a tube
        a = x;
        b = light.extent.y * normalize(cross(x, l) + 1e-9 * up);
    } else if (light.extent.z > 1.5) {  // a disk or a rect
        a = light.extent.x * x;
        b = light.extent.y * cross(x, light.axis_radius.xyz);
    } else {                            // a ball or the sun
        a = light.extent.x * normalize(cross(up, l));
        b = light.extent.x * normalize(cross(l, a));
    }
}

// Share of a cell's texels that are deeper than a threshold: exact where it holds a caster and what is behind it.
float share_hidden(vec3 depths, float threshold)
{
    if (depths.y <= threshold) return 0.0;
    return depths.x > threshold ? 1.0 : (depths.z - depths.x) / max(depths.y - depths.x, 1e-12);
}

// A light's outline in a map: the row of its light, and in cells of the map, where it lies and how wide it is.
struct Kernel { int row; bool is_round; mat2 from_cells; vec2 middle; vec2 width; };

// Share of a cell that lies within the outline, of each colour.
Share kernel_weight(Kernel k, vec2 cell)
{
    vec2 at = k.from_cells * (cell - k.middle);
    Share weight = Share(k.is_round ? clamp((1.0 - length(at)) * min(k.width.x, k.width.y) + 0.5, 0.0, 1.0)
                                    : clamp((1.0 - abs(at.x)) * k.width.x + 0.5, 0.0, 1.0) * clamp((1.0 - abs(at.y)) * k.width.y + 0.5, 0.0, 1.0));
#ifdef COLORED_SHADOWS
    weight *= cell_color(k.row, at, 1.0 / k.width);
#endif
    return weight;
}

// Share of a kernel around a place of the map that is deeper than a threshold; 0 where it is not needed. Its half axes are u and v
// times a scale.
Share kernel_share(int row, int map, vec2 uv, vec2 u, vec2 v, float scale, bool is_round, float threshold, float most_cells)
{
    float side = float(textureSize(shadow_depths, 0).x), levels = float(textureQueryLevels(shadow_cells));
    vec2 half_size = scale * (abs(u) + abs(v));
    int level = int(clamp(ceil(log2(max(max(half_size.x, half_size.y) * side / max(most_cells, 1.0), 1.0))), 0.0, levels));
    int cells_across = textureSize(shadow_depths, 0).x >> level;
    float cells = float(cells_across);
    // an axis at least as long as softens the map's own edges
    float least_cells = level == 0 ? 1.5 : 0.75;
    u *= max(scale * cells, least_cells * inversesqrt(max(dot(u, u), 1e-20)));
    v *= max(scale * cells, least_cells * inversesqrt(max(dot(v, v), 1e-20)));
    float area = u.x * v.y - u.y * v.x;
    mat2 to_kernel = mat2(v.y, -u.y, -v.x, u.x) / (abs(area) > 1e-6 ? area : 1e-6);
    half_size = is_round ? sqrt(u * u + v * v) : abs(u) + abs(v);
    float width_u = abs(area) * inversesqrt(dot(v, v)), width_v = abs(area) * inversesqrt(dot(u, u));
    vec2 middle = uv * cells - 0.5;
    ivec2 first = ivec2(ceil(middle - half_size - 0.5)), count = ivec2(floor(middle + half_size + 0.5)) - first + 1;
    count = most_cells > 0.0 ? clamp(count, ivec2(0), ivec2(2.0 * most_cells) + 4) : ivec2(0);
    Share hidden = Share(0.0), sum = Share(0.0);
    Kernel kernel = Kernel(row, is_round, to_kernel, middle, vec2(width_u, width_v));
    ivec2 last = ivec2(cells_across - 1), place = first, end = first + count;
    int texels = level == 0 ? count.x * count.y : 0, squares = level == 0 ? 0 : count.x * count.y;
    // two loops: Mesa's CPU rasteriser runs both sides of a branch, and skips a loop that no pixel enters
    for (int i = 0; i < texels; ++i) {
        Share weight = kernel_weight(kernel, vec2(place));
        float depth = texelFetch(shadow_depths, ivec3(clamp(place, ivec2(0), last), map), 0).r;
        hidden += depth > threshold ? weight : Share(0.0);
        sum += weight;
        place.x += 1;
        if (place.x == end.x) place = ivec2(first.x, place.y + 1);
    }
    for (int i = 0; i < squares; ++i) {
        Share weight = kernel_weight(kernel, vec2(place));
        vec3 depths = texelFetch(shadow_cells, ivec3(clamp(place, ivec2(0), last), map), level - 1).rgb;
        hidden += weight * share_hidden(depths, threshold);
        sum += weight;
        place.x += 1;
        if (place.x == end.x) place = ivec2(first.x, place.y + 1);
    }
    return hidden / max(sum, Share(1e-20));
}

// Share of a shadow that is left at its distance from the caster (UsdLux, ShadowAPI).
float shadow_strength(Light light, float apart, float distance_m, float ahead_m)
{
    float between = light.soft.x * apart;  // of a light with a place: difference of 1/distance along the map's axis
    if (light.position_kind.w > 0.5) between = distance_m * (1.0 - 1.0 / (1.0 + ahead_m * between));
    float inside = (light.soft.y - between) / max(light.soft.z, 1e-6);
    return inside <= 0.0 ? 0.0 : pow(min(inside, 1.0), light.soft.w);
}

Share soft_visibility(Light light, int row, int map, vec3 at, vec3 l, float distance_m, float ahead_m)
{
    mat4 clip = shadows.clip_from_camera[map];
    vec3 right = vec3(clip[0].x, clip[1].x, clip[2].x), up = vec3(clip[0].y, clip[1].y, clip[2].y);
    vec3 ahead = vec3(clip[0].w, clip[1].w, clip[2].w), a, b;
    outline_axes(light, up, l, a, b);
    bool is_round = light.extent.z < 2.5;
    // half axes of the kernel in the map for a depth of 1 between caster and receiver
    vec2 u = 0.5 * light.soft.x * (vec2(dot(a, right), dot(a, up)) - at.xy * dot(a, ahead));
    vec2 v = 0.5 * light.soft.x * (vec2(dot(b, right), dot(b, up)) - at.xy * dot(b, ahead));
    vec2 uv = at.xy * 0.5 + 0.5, reach = abs(u) + abs(v), texel = 1.0 / vec2(textureSize(shadow_depths, 0).xy);
    vec2 range = texelFetch(shadow_cells, ivec3(0, 0, map), textureQueryLevels(shadow_cells) - 1).rg - at.z;
    float between = range.y;
    bool is_limited = light.soft.y >= 0.0;
    for (int i = 0; i < 3; ++i) {
        // Nothing hides the light, or everything does. A limited shadow goes on, since it needs its caster's distance.
        if (between <= 0.0 || (range.x > 0.0 && !is_limited)) break;
        range = depth_range(map, uv, max(between, 0.0) * reach + 1.5 * texel) - at.z;
        between = min(between, range.y);
    }
    // all lit, all hidden, or neither
    bool is_between = between > 0.0 && range.x <= 0.0;
    int searched = is_between || (is_limited && between > 0.0) ? SEARCHED : 0;
    float sum = 0.0, count = 0.0, least = between;
    vec2 turn = vec2(1.0, 0.0);
    for (int i = 0; i < searched; ++i) {
        // golden angle (Vogel 1979); a rect's kernel is the square around
        turn = vec2(-0.737369 * turn.x - 0.675490 * turn.y, 0.675490 * turn.x - 0.737369 * turn.y);
        float away = float(i) / float(SEARCHED);
        away *= sqrt(away);  // near contact, what hides the light lies near the middle
        vec2 place = is_round ? away * turn : away * turn / max(abs(turn.x), abs(turn.y));
        vec2 offset = between * (place.x * u + place.y * v) + texel * place;
        float nearer = textureLod(shadow_depths, vec3(uv + offset, float(map)), 0.0).r - at.z;
        bool hides = nearer > 0.0 && nearer >= away * between * 0.99;
        sum += hides ? nearer : 0.0;
        count += hides ? 1.0 : 0.0;
        least = hides ? min(least, nearer) : least;
    }
    // where none was met, there may still be one at the outline's edge
    float apart = count > 0.0 ? sum / count : max(between, 0.0);
    float threshold = at.z + (count > 0.0 ? 0.5 : 0.8) * least;
    Share hidden = kernel_share(row, map, uv, u, v, apart, is_round, threshold, is_between ? MOST_CELLS[count > 0.0 ? 1 : 0] : 0.0);
    if (range.x > 0.0) hidden = Share(1.0);
    return 1.0 - hidden * (is_limited ? shadow_strength(light, apart, distance_m, ahead_m) : 1.0);
}
