// Where lens rays meet peeled layers: ranges of inverse depth under a footprint, and the walk along a ray.
// A ray is a line in (pixel, inverse depth): s(w) = a + b·w, in layer pixels, px·m and 1/m.
// Lee, Eisemann & Seidel 2010, section 3.1.

uniform sampler2D packed_w;     // of layers 0 to 3, near to far: 1/m; 0 empty, negative partly transparent
#ifdef EIGHT_LAYERS
uniform sampler2D packed_w_far; // of layers 4 to 7
#endif
uniform sampler2DArray radiance;
uniform sampler2DArray ranges;  // N-buffers
uniform sampler2D background;

uniform int last_level;         // of the N-buffers
uniform float slope_slack;      // share of w by which a surface may slope within a pixel

const int BLOCK = 4;
const int MAX_STEPS = 160;      // a ray that crosses more pixels strides over some; where it lands is looked at again

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

// What a ray sees: premultiplied radiance and coverage, composited front to back.
vec4 march(vec2 a, vec2 b, vec2 range)
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
