// Intersection of lens rays with the sharp layer: opaque surfaces nearly in focus, at twice the layers' resolution.
// A short walk, since a ray crosses few texels within the range of inverse depth that is nearly in focus.

uniform sampler2D sharp_w;          // 1/m; 0 or less where empty
uniform usampler2D sharp_slopes;
uniform sampler2D sharp_radiance;
uniform sampler2DArray sharp_ranges;  // N-buffers of the sharp layer
uniform int sharp_last_level;
uniform ivec2 sharp_offset;         // texel of the layers at the sharp layer's corner
uniform vec2 sharp_w_range;         // range of w in which rays may meet its surfaces

const float SHARP_FINER = 2.0;
const int MAX_SHARP_STEPS = 64;

vec2 sharp_range;                   // range of w in which this pixel's rays may meet the sharp layer; the second is 0 where none

// A surface of the sharp layer that a ray meets: w (0 for none), and the texel of its radiance.
struct SharpHit { float w; ivec2 pixel; };

// Range of w in the sharp layer over the layers' pixels from `low` to `high`.
vec2 sharp_range_over(ivec2 low, ivec2 high)
{
    ivec2 last = textureSize(sharp_ranges, 0).xy - 1;
    ivec2 from = 2 * (low - sharp_offset) - 1, to = 2 * (high - sharp_offset) + 2;
    if (any(lessThan(to, ivec2(0))) || any(greaterThan(from, 4 * last + 3))) return vec2(0.0);
    ivec2 a = clamp(from / BLOCK, ivec2(0), last), b = clamp(to / BLOCK, ivec2(0), last);
    ivec2 extent = b - a + 1;
    int level = min(findMSB(max(extent.x, extent.y)), sharp_last_level);
    ivec2 c = max(b - (1 << level) + 1, a);
    vec2 r0 = texelFetch(sharp_ranges, ivec3(a, level), 0).xy;
    vec2 r1 = texelFetch(sharp_ranges, ivec3(c.x, a.y, level), 0).xy;
    vec2 r2 = texelFetch(sharp_ranges, ivec3(a.x, c.y, level), 0).xy;
    vec2 r3 = texelFetch(sharp_ranges, ivec3(c, level), 0).xy;
    return vec2(min(min(r0.x, r1.x), min(r2.x, r3.x)), max(max(r0.y, r1.y), max(r2.y, r3.y)));
}

// Nearest surface of the sharp layer that a ray meets.
SharpHit sharp_hit(vec2 a, vec2 b)
{
    SharpHit hit = SharpHit(0.0, ivec2(0));
    if (sharp_range.y <= 0.0) return hit;
    a *= SHARP_FINER;
    b *= SHARP_FINER;
    ivec2 first = 2 * sharp_offset, size = textureSize(sharp_w, 0);
    float span = sharp_range.y - sharp_range.x;
    int steps = clamp(int(ceil(max(abs(b.x), abs(b.y)) * span)), 1, MAX_SHARP_STEPS);
    float dw = span / float(steps);
    for (int step = 0; step < steps && hit.w == 0.0; ++step) {
        float high = sharp_range.y - dw * float(step), low = high - dw, pad = OVERLAP * dw + LEAST_PAD * high;
        ivec2 pixel = ivec2(floor(a + b * (0.5 * (high + low)))) - first;
        if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) continue;
        float w = texelFetch(sharp_w, pixel, 0).r;
        if (w <= 0.0) continue;
        uvec4 held = uvec4(texelFetch(sharp_slopes, pixel, 0).r);
        float gx = w * unpacked_slopes(held).x, gy = w * unpacked_slopes(held >> 8).x;
        float along = 1.0 - gx * b.x - gy * b.y, reach = min(abs(gx) + abs(gy), 2.0 * LONGEST_REACH * w);
        vec2 off = a - (vec2(pixel + first) + 0.5);
        float met = (w + gx * off.x + gy * off.y) / (abs(along) < 1e-4 ? 1e-4 : along);
        met = clamp(met, w - reach, w + reach);
        if (met < low - pad || met > high + pad) continue;
        ivec2 there = clamp(ivec2(floor(a + b * met)) - first, ivec2(0), size - 1);
        float w_there = texelFetch(sharp_w, there, 0).r;
        hit = SharpHit(met, abs(w_there - met) <= reach + UNLIKE * met ? there : pixel);
    }
    return hit;
}

// Whether the sharp layer stops a ray of the pixel at `centre` in front of inverse depth `front`.
bool sharp_stops(vec2 centre, vec2 a, vec2 b, float front)
{
    vec2 range = vec2(max(front, sharp_w_range.x), sharp_w_range.y);
    sharp_range = vec2(0.0);
    if (range.y <= range.x) return false;
    vec2 near = a + b * range.y, far = a + b * range.x;
    vec4 box = square_toward(centre, min(near, far), max(near, far));
    vec2 held = sharp_range_over(ivec2(floor(box.xy)), ivec2(floor(box.zw)));
    range = vec2(max(range.x, held.x), min(range.y, held.y));
    if (range.y < range.x) return false;
    float pad = 1e-4 * range.y;
    sharp_range = vec2(max(range.x - pad, front), range.y + pad);
    return sharp_hit(a, b).w > front;
}
