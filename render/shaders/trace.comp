#version 450 core
// Traces lens rays through peeled layers and adds what they meet.
// in:  packed inverse depths of the layers (1/m; negative partly transparent), their radiance, N-buffers, background;
//      rays: pupil point (unit pupil, y down), sensor offset (pixels of the picture), weight
// out: sum of weighted radiance and coverage in `sum` (premultiplied), added to what is there
// Lee, Eisemann & Seidel 2010, section 3.1. A ray is a line in (pixel, inverse depth): s(w) = a + b·w; all pixels here are
// the layers', guard band included.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;

struct Ray {
    vec4 pupil_pixel;   // xy pupil, zw sensor offset
    vec4 weight;        // x weight
};
layout(std430, binding = 4) readonly buffer RayBlock { Ray rays[]; };

uniform sampler2D packed_w;
uniform sampler2DArray radiance;
uniform sampler2DArray ranges;
uniform sampler2D background;

uniform ivec2 tile_origin;      // of the picture's pixels that this dispatch works on
uniform int supersample;
uniform float guard_px;
uniform vec2 pupil_px;          // focal length times pupil radius, layer px·m
uniform vec3 focus;             // w_f at the picture's pixel (x, y) is focus.x + focus.y·x + focus.z·y
uniform int first_ray;
uniform int ray_count;
uniform int pattern_rays;       // rays in one pattern
uniform int tile_side;          // patterns repeat in tiles of this side
uniform int last_level;         // of the N-buffers
uniform float slope_slack;      // share of w by which a surface may slope within a pixel

const int BLOCK = 4;
const int ROUNDS = 3;
const int MAX_STEPS = 160;  // a ray that crosses more pixels than this strides over some; where it lands is looked at again

// Range of w over the layer pixels from `low` to `high`, in four look-ups of overlapping squares.
vec2 range_over(ivec2 low, ivec2 high)
{
    ivec2 last = textureSize(ranges, 0).xy - 1;
    ivec2 a = clamp(low / BLOCK, ivec2(0), last), b = clamp(high / BLOCK, ivec2(0), last);
    ivec2 extent = b - a + 1;
    int level = min(findMSB(max(extent.x, extent.y)), last_level);
    ivec2 c = max(b - (1 << level) + 1, a);
    vec2 r0 = texelFetch(ranges, ivec3(a, level), 0).xy;
    vec2 r1 = texelFetch(ranges, ivec3(c.x, a.y, level), 0).xy;
    vec2 r2 = texelFetch(ranges, ivec3(a.x, c.y, level), 0).xy;
    vec2 r3 = texelFetch(ranges, ivec3(c, level), 0).xy;
    return vec2(min(min(r0.x, r1.x), min(r2.x, r3.x)), max(max(r0.y, r1.y), max(r2.y, r3.y)));
}

// Narrow the range of w in which any ray of the pixel can meet a surface: the footprint of the range before bounds the next.
vec2 bound_footprint(vec2 p, float w_f, float reach)
{
    vec2 range = texelFetch(ranges, ivec3(0, 0, last_level), 0).xy;
    for (int i = 0; i < ROUNDS && range.y > 0.0; ++i) {
        vec2 radius = pupil_px * max(abs(range.x - w_f), abs(range.y - w_f)) + reach;
        range = range_over(ivec2(floor(p - radius)), ivec2(floor(p + radius)));
    }
    return range;
}

struct Hit { float w; int layer; bool opaque; };

// The surface that was met, looked at again where the ray meets it: the step found it in the pixel under the step's middle.
ivec2 exact_pixel(ivec2 found, ivec2 at, Hit hit, float tolerance)
{
    if (at == found) return found;
    float w = texelFetch(packed_w, at, 0)[hit.layer];
    return abs(abs(w) - hit.w) <= tolerance && (w > 0.0) == hit.opaque ? at : found;
}

// The nearest surface of a pixel within (low, high) of w, in front of `limit`.
Hit nearest_in(vec4 stored, float low, float high, float limit)
{
    vec4 w = abs(stored);
    bvec4 inside = bvec4(w.x >= low && w.x <= high && w.x < limit, w.y >= low && w.y <= high && w.y < limit,
                         w.z >= low && w.z <= high && w.z < limit, w.w >= low && w.w <= high && w.w < limit);
    if (inside.x && w.x > 0.0) return Hit(w.x, 0, stored.x > 0.0);   // layers come near to far in each pixel
    if (inside.y && w.y > 0.0) return Hit(w.y, 1, stored.y > 0.0);
    if (inside.z && w.z > 0.0) return Hit(w.z, 2, stored.z > 0.0);
    if (inside.w && w.w > 0.0) return Hit(w.w, 3, stored.w > 0.0);
    return Hit(0.0, -1, false);
}

// What a ray sees: premultiplied radiance and coverage, composited front to back.
vec4 trace(vec2 a, vec2 b, vec2 range)
{
    ivec2 last = textureSize(packed_w, 0) - 1;
    vec4 seen = vec4(0.0);
    if (range.y > 0.0) {
        vec2 span = abs(b) * (range.y - range.x);
        int steps = clamp(int(ceil(max(span.x, span.y))), 1, MAX_STEPS);
        float dw = (range.y - range.x) / float(steps);
        float pad = min(0.5 * dw, HALF_PIXEL_SHARE / max(max(abs(b.x), abs(b.y)), 1e-12));
        float limit = 1e30;
        for (int k = 0; k < steps; ++k) {
            float high = range.y - dw * float(k), low = high - dw;
            ivec2 pixel = clamp(ivec2(floor(a + b * (0.5 * (high + low)))), ivec2(0), last);
            vec4 stored = texelFetch(packed_w, pixel, 0);
            if (stored.x == 0.0) continue;
            Hit hit = nearest_in(stored, low - pad - slope_slack * low, high + pad + slope_slack * high, limit);
            while (hit.layer >= 0) {
                ivec2 at = clamp(ivec2(floor(a + b * hit.w)), ivec2(0), last);
                at = exact_pixel(pixel, at, hit, pad + slope_slack * hit.w);
                vec4 surface = texelFetch(radiance, ivec3(at, hit.layer), 0);
                float share = (1.0 - seen.a) * (hit.opaque ? 1.0 : surface.a);
                seen += share * vec4(surface.rgb, 1.0);
                if (hit.opaque) return seen;
                limit = hit.w;
                hit = nearest_in(stored, low - pad - slope_slack * low, high + pad + slope_slack * high, limit);
            }
        }
    }
    vec3 behind = texelFetch(background, clamp(ivec2(floor(a)), ivec2(0), last), 0).rgb;
    return vec4(seen.rgb + (1.0 - seen.a) * behind, seen.a);
}

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + tile_origin;
    if (any(greaterThanEqual(pixel, imageSize(sum)))) return;
    float scale = float(supersample);
    vec2 p = (vec2(pixel) + 0.5) * scale + guard_px;
    float w_f = focus.x + dot(focus.yz, vec2(pixel) + 0.5);
    vec2 range = bound_footprint(p, w_f, 0.5 * scale + 1.0);
    int pattern = (pixel.y % tile_side) * tile_side + pixel.x % tile_side;
    vec4 total = imageLoad(sum, pixel);
    for (int i = 0; i < ray_count; ++i) {
        Ray ray = rays[pattern * pattern_rays + first_ray + i];
        vec2 b = pupil_px * ray.pupil_pixel.xy;
        vec2 a = p + scale * ray.pupil_pixel.zw - b * w_f;
        total += ray.weight.x * trace(a, b, range);
    }
    imageStore(sum, pixel, total);
}
