// Where lens rays meet peeled layers: ranges of inverse depth under a footprint, and the walk along a ray.
// A ray is a line in (pixel, inverse depth): s(w) = a + b·w, in layer pixels, px·m and 1/m.
// Lee, Eisemann & Seidel 2010, section 3.1.

uniform sampler2D packed_w;     // of layers 0 to 3, near to far: 1/m; 0 empty, negative partly transparent
#ifdef EIGHT_LAYERS
uniform sampler2D packed_w_far; // of layers 4 to 7
#endif
uniform sampler2DArray radiance;
uniform sampler2DArray ranges;  // N-buffers
uniform usampler2DArray bins;
uniform sampler2D background;

uniform int last_level;         // of the N-buffers
uniform float slope_slack;      // share of w by which a surface may slope within a pixel

#include "bins.glsl"

const int BLOCK = 4;
const int MAX_RUNS = 8;         // stretches of w with surfaces that a pixel's rays look into; more are joined
const int MAX_STEPS = 160;      // a ray that crosses more pixels strides over some; where it lands is looked at again

struct Corners { ivec2 a; ivec2 c; int level; };

// The four overlapping squares of an N-buffer that cover the layer pixels from `low` to `high`.
Corners corners_over(ivec2 low, ivec2 high)
{
    ivec2 last = textureSize(ranges, 0).xy - 1;
    ivec2 a = clamp(low / BLOCK, ivec2(0), last), b = clamp(high / BLOCK, ivec2(0), last);
    ivec2 extent = b - a + 1;
    int level = min(findMSB(max(extent.x, extent.y)), last_level);
    return Corners(a, max(b - (1 << level) + 1, a), level);
}

// Range of w over the layer pixels from `low` to `high`.
vec2 range_over(ivec2 low, ivec2 high)
{
    Corners s = corners_over(low, high);
    vec2 r0 = texelFetch(ranges, ivec3(s.a, s.level), 0).xy;
    vec2 r1 = texelFetch(ranges, ivec3(s.c.x, s.a.y, s.level), 0).xy;
    vec2 r2 = texelFetch(ranges, ivec3(s.a.x, s.c.y, s.level), 0).xy;
    vec2 r3 = texelFetch(ranges, ivec3(s.c, s.level), 0).xy;
    return vec2(min(min(r0.x, r1.x), min(r2.x, r3.x)), max(max(r0.y, r1.y), max(r2.y, r3.y)));
}

// Bins of w that hold a surface of those pixels.
uvec2 bins_over(ivec2 low, ivec2 high)
{
    Corners s = corners_over(low, high);
    return texelFetch(bins, ivec3(s.a, s.level), 0).xy | texelFetch(bins, ivec3(s.c.x, s.a.y, s.level), 0).xy
         | texelFetch(bins, ivec3(s.a.x, s.c.y, s.level), 0).xy | texelFetch(bins, ivec3(s.c, s.level), 0).xy;
}

vec2 range_of_all()
{
    return texelFetch(ranges, ivec3(0, 0, last_level), 0).xy;
}

struct Hit { float w; int layer; bool opaque; };

// The nearest of four surfaces of a pixel within (low, high) of w, in front of `limit`.
Hit nearest_of_four(vec4 stored, float low, float high, float limit)
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

#ifdef EIGHT_LAYERS
// The second four are looked at only where the first are all there: once a pixel is empty, it stays empty.
Hit nearest_in(ivec2 pixel, vec4 stored, float low, float high, float limit)
{
    Hit hit = nearest_of_four(stored, low, high, limit);
    if (hit.layer >= 0 || stored.w == 0.0) return hit;
    hit = nearest_of_four(texelFetch(packed_w_far, pixel, 0), low, high, limit);
    if (hit.layer >= 0) hit.layer += 4;
    return hit;
}

float stored_w(ivec2 pixel, int layer)
{
    return layer < 4 ? texelFetch(packed_w, pixel, 0)[layer] : texelFetch(packed_w_far, pixel, 0)[layer - 4];
}
#else
Hit nearest_in(ivec2 pixel, vec4 stored, float low, float high, float limit)
{
    return nearest_of_four(stored, low, high, limit);
}

float stored_w(ivec2 pixel, int layer)
{
    return texelFetch(packed_w, pixel, 0)[layer];
}
#endif

// The surface that was met, looked at again where the ray meets it: the step found it in the pixel under the step's middle.
ivec2 exact_pixel(ivec2 found, ivec2 at, Hit hit, float tolerance)
{
    if (at == found) return found;
    float w = stored_w(at, hit.layer);
    return abs(abs(w) - hit.w) <= tolerance && (w > 0.0) == hit.opaque ? at : found;
}

// The stretches of w, near to far, that a pixel's rays look into.
vec2 runs[MAX_RUNS];
int run_count;

// Runs of filled bins within `range`. A run ends with its bin and a little more, since a surface reaches beyond its own w.
void find_runs(uvec2 held, vec2 range)
{
    vec2 all = range_of_all();
    float width = (all.y - all.x) / float(BINS);
    run_count = 0;
    int above = BINS;  // bins from here on are done
    while (true) {
        uvec2 left = above > 0 ? held & bits_between(0, above - 1) : uvec2(0u);
        int top = left.y != 0u ? 32 + findMSB(left.y) : findMSB(left.x);
        if (top < 0) break;
        uvec2 empty = top > 0 ? ~held & bits_between(0, top - 1) : uvec2(0u);
        above = 1 + (empty.y != 0u ? 32 + findMSB(empty.y) : findMSB(empty.x));
        vec2 run = vec2(max(all.x + float(above) * width, range.x), min(all.x + float(top + 1) * width, range.y));
        if (run_count < MAX_RUNS) runs[run_count++] = run;
        else runs[MAX_RUNS - 1].x = run.x;
    }
}

// What a ray sees: premultiplied radiance and coverage, composited front to back.
vec4 march(vec2 a, vec2 b)
{
    ivec2 last = textureSize(packed_w, 0) - 1;
    vec4 seen = vec4(0.0);
    float limit = 1e30, rate = max(max(abs(b.x), abs(b.y)), 1e-12);
    for (int i = 0; i < run_count; ++i) {
        vec2 range = runs[i];
        int steps = clamp(int(ceil(rate * (range.y - range.x))), 1, MAX_STEPS);
        float dw = (range.y - range.x) / float(steps);
        float pad = min(0.5 * dw, HALF_PIXEL_SHARE / rate);
        for (int k = 0; k < steps; ++k) {
            float high = range.y - dw * float(k), low = high - dw;
            ivec2 pixel = clamp(ivec2(floor(a + b * (0.5 * (high + low)))), ivec2(0), last);
            vec4 stored = texelFetch(packed_w, pixel, 0);
            if (stored.x == 0.0) continue;
            low -= pad + slope_slack * low;
            high += pad + slope_slack * high;
            Hit hit = nearest_in(pixel, stored, low, high, limit);
            while (hit.layer >= 0) {
                ivec2 at = clamp(ivec2(floor(a + b * hit.w)), ivec2(0), last);
                at = exact_pixel(pixel, at, hit, pad + slope_slack * hit.w);
                vec4 surface = texelFetch(radiance, ivec3(at, hit.layer), 0);
                float share = (1.0 - seen.a) * (hit.opaque ? 1.0 : surface.a);
                seen += share * vec4(surface.rgb, 1.0);
                if (hit.opaque) return seen;
                limit = hit.w;
                hit = nearest_in(pixel, stored, low, high, limit);
            }
        }
    }
    vec3 behind = texelFetch(background, clamp(ivec2(floor(a)), ivec2(0), last), 0).rgb;
    return vec4(seen.rgb + (1.0 - seen.a) * behind, seen.a);
}
