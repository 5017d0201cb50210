#version 450 core
// Focal surface: the inverse depth in focus and the pupil's radius at each pixel, as in `render.focus.surface`, term by term.
// in:  plane, control points, half lenses, drawn curvature of field (focal_surface.py); the lens's chief rays
// out: w_f (1/m) and the pupil's radius relative to the lens's own, in `focal_map`
// Lee, Eisemann & Seidel 2010, section 5.2. Slopes are of object space, x right and y up.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 1) uniform writeonly image2D focal_map;  // the tracer keeps its sum at 0

struct Control {
    vec4 at;        // position (slopes), weight, falloff (slopes)
    vec4 what;      // two values
};
layout(std430, binding = 0) readonly buffer Points { Control points[]; };   // w and logarithm of the extent
layout(std430, binding = 1) readonly buffer Bends { Control bends[]; };     // change of w
layout(std430, binding = 2) readonly buffer Stretch { vec2 stretch[]; };    // ratios of seen slope to picture slope, over the height

uniform ivec2 area_first;       // pixel of the picture that the map begins with
uniform vec2 centre;            // where the view axis meets the picture
uniform vec2 focal_px;
uniform vec3 plane;             // w on the axis, and its change with the slope to the right and up
uniform int point_count;
uniform float point_exponent;
uniform float blend;
uniform int bend_count;
uniform float bend_exponent;
uniform int half_count;
uniform vec4 half_edges[2];     // direction, offset, width
uniform float half_w[2];
uniform int stretch_count;      // 0: chief rays go straight
uniform float last_height;      // height of the last ratio

const float LEAST_D2 = 1e-14;

// Slope in object space seen at a slope of the picture.
vec2 seen_at(vec2 slope)
{
    if (stretch_count == 0) return slope;
    float at = clamp(length(slope) / last_height, 0.0, 1.0) * float(stretch_count - 1);
    int low = min(int(at), stretch_count - 2);
    return slope * mix(stretch[low], stretch[low + 1], at - float(low));
}

// Shepard's mean: sums over the points, with shares relative to the nearest point's.
void add(Control control, vec2 slope, float exponent, inout float nearest, inout float total, inout vec2 sum, inout float missed)
{
    if (control.at.z <= 0.0) return;
    vec2 away = slope - control.at.xy;
    float d2 = max(dot(away, away), LEAST_D2), falloff = control.at.w;
    float inside = falloff > 0.0 ? clamp(1.0 - d2 / (falloff * falloff), 0.0, 1.0) : 1.0;
    float reach = inside * inside;
    missed *= 1.0 - reach;
    if (reach == 0.0) return;
    if (d2 < nearest) {     // the sums so far are relative to a farther point
        float fade = nearest > 1e29 ? 0.0 : pow(d2 / nearest, 0.5 * exponent);
        total *= fade;
        sum *= fade;
        nearest = d2;
    }
    float share = control.at.z * reach * pow(nearest / d2, 0.5 * exponent);
    total += share;
    sum += share * control.what.xy;
}

float beyond_edge(vec4 edge, vec2 slope)
{
    float t = clamp((dot(slope, edge.xy) - edge.z) / max(edge.w, 1e-9) + 0.5, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(focal_map)))) return;
    vec2 slope = seen_at(vec2(1.0, -1.0) * (vec2(pixel + area_first) + 0.5 - centre) / focal_px);
    float w = plane.x + dot(plane.yz, slope), log_pupil = 0.0;
    float nearest = 1e30, total = 0.0, missed = 1.0;
    vec2 sum = vec2(0.0);
    for (int i = 0; i < point_count; ++i) add(points[i], slope, point_exponent, nearest, total, sum, missed);
    if (total > 0.0) {
        float share = blend * (1.0 - missed);
        w += share * (sum.x / total - w);
        log_pupil = -share * sum.y / total;
    }
    for (int i = 0; i < half_count; ++i) w += beyond_edge(half_edges[i], slope) * (half_w[i] - w);
    nearest = 1e30;
    total = 0.0;
    missed = 1.0;
    sum = vec2(0.0);
    for (int i = 0; i < bend_count; ++i) add(bends[i], slope, bend_exponent, nearest, total, sum, missed);
    if (total > 0.0) w += (1.0 - missed) * sum.x / total;
    imageStore(focal_map, pixel, vec4(w, exp(log_pupil), 0.0, 0.0));
}
