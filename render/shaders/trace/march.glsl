// Intersection of lens rays with peeled layers, by a walk along the ray.
// A ray is a line in (pixel, inverse depth): s(w) = a + b·w, in layer pixels, px·m and 1/m. A pixel's surface is a plane, which is
// a plane in (pixel, inverse depth) too, so that ray and surface meet at a point and silhouettes keep their width.
// Lee, Eisemann & Seidel 2010, section 3.1.

uniform sampler2D packed_w;     // w of layers 0 to 3, near to far: 1/m; 0 empty, negative partly transparent
uniform usampler2D slopes;      // slopes of w of these layers
#ifdef EIGHT_LAYERS
uniform sampler2D packed_w_far; // w of layers 4 to 7
uniform usampler2D slopes_far;
#endif
uniform sampler2DArray radiance;
uniform sampler2D background;

#include "layers/coverage.glsl"
#include "trace/footprints.glsl"
#include "trace/slopes.glsl"
#ifdef SPLATS
#include "trace/splat_planes.glsl"
#endif

#ifdef MOVERS
#include "layers/carried.glsl"
uniform usampler2DArray motion; // motion of surfaces while the shutter is open (surface.frag)
uniform sampler2DArray movers;  // moving surfaces of each block (movers.comp)
layout(std430, binding = 3) readonly buffer Arrivals { uvec4 arrivals[]; };  // movers that arrive in each block (arrivals.comp)

// Surfaces that may move into a pixel at this moment; none where the third number is 0.
uvec4 arrivals_at(ivec2 pixel)
{
    return arrivals[(pixel.y / BLOCK) * textureSize(ranges, 0).x + pixel.x / BLOCK];
}

// Motion of a layer's surface at this moment, and 1 where it moves.
vec4 motion_at(ivec2 pixel, int layer)
{
    uvec4 stored = texelFetch(motion, ivec3(pixel, layer), 0);
    return stored.w == 0u ? vec4(0.0) : vec4(motion_in_half(stored, shutter_time >= 0.0), 1.0);
}
#endif

const int MAX_STEPS = 160;      // a ray that crosses more pixels skips some; the pixel of a hit is read again
const float OVERLAP = 0.05;     // share of a step by which steps overlap, so that rays do not slip through cracks
const float LEAST_PAD = 1e-5;   // share of w: rounding

// A surface that a ray meets; `reach`: greatest change of its w within a pixel, 1/m.
struct Hit { float w; int layer; bool opaque; float reach; };

// A segment of a ray in w, the layer pixel under its middle, and the stored w of its first four layers.
struct Segment { float low; float high; ivec2 pixel; vec4 stored; };

// A walk along a ray: near to far through the pixel's intervals of w, about a layer pixel a step.
struct Walk { vec2 a; vec2 b; float rate; int interval; int steps; int step; float top; float dw; };

// Whether each of four surfaces, met at `w`, exists, is within the segment and in front of `limit`.
bvec4 met_within(vec4 w, vec4 stored, Segment at, float limit)
{
    vec4 there = vec4(notEqual(stored, vec4(0.0)));
    return notEqual(there * step(at.low, w) * step(w, vec4(at.high)) * vec4(lessThan(w, vec4(limit))), vec4(0.0));
}

// Nearest of four surfaces of a pixel that a ray meets within the segment, in front of `limit`. Each is extended as a plane as far
// as the centres of the neighbouring pixels.
Hit nearest_of_four(vec4 stored, uvec4 held, vec2 a, vec2 b, Segment at, float limit)
{
    vec4 w = abs(stored), gx = w * unpacked_slopes(held), gy = w * unpacked_slopes(held >> 8);
    vec4 along = 1.0 - gx * b.x - gy * b.y, reach = min(abs(gx) + abs(gy), 2.0 * LONGEST_REACH * w);
    vec2 off = a - (vec2(at.pixel + layer_first) + 0.5);
    vec4 met = (w + gx * off.x + gy * off.y) / mix(along, vec4(1e-4), lessThan(abs(along), vec4(1e-4)));
    met = clamp(met, w - reach, w + reach);
    bvec4 inside = met_within(met, stored, at, limit);
    Hit hit = Hit(0.0, -1, false, 0.0);
    if (inside.x) hit = Hit(met.x, 0, stored.x > 0.0, reach.x);
    if (inside.y && met.y > hit.w) hit = Hit(met.y, 1, stored.y > 0.0, reach.y);
    if (inside.z && met.z > hit.w) hit = Hit(met.z, 2, stored.z > 0.0, reach.z);
    if (inside.w && met.w > hit.w) hit = Hit(met.w, 3, stored.w > 0.0, reach.w);
    return hit;
}

#ifdef EIGHT_LAYERS
// The second four layers are read only where the first four are all filled: after an empty layer, all are empty.
Hit nearest_in(vec2 a, vec2 b, Segment at, float limit)
{
    Hit hit = nearest_of_four(at.stored, texelFetch(slopes, at.pixel, 0), a, b, at, limit);
    if (hit.layer >= 0 || at.stored.w == 0.0) return hit;
    hit = nearest_of_four(texelFetch(packed_w_far, at.pixel, 0), texelFetch(slopes_far, at.pixel, 0), a, b, at, limit);
    if (hit.layer >= 0) hit.layer += 4;
    return hit;
}

float stored_w(ivec2 pixel, int layer)
{
    return layer < 4 ? texelFetch(packed_w, pixel, 0)[layer] : texelFetch(packed_w_far, pixel, 0)[layer - 4];
}

// Whether the segment may meet a surface; the second four layers are behind the fourth.
bool may_meet(Segment at)
{
    float behind = abs(at.stored.w) * (1.0 + 2.0 * LONGEST_REACH);
    vec4 w = abs(at.stored), room = 2.0 * LONGEST_REACH * w;
    bvec4 near = notEqual(step(at.low, w + room) * step(w - room, vec4(at.high)), vec4(0.0));
    return any(near) || (at.stored.w != 0.0 && at.low <= behind);
}
#else
Hit nearest_in(vec2 a, vec2 b, Segment at, float limit)
{
    return nearest_of_four(at.stored, texelFetch(slopes, at.pixel, 0), a, b, at, limit);
}

float stored_w(ivec2 pixel, int layer)
{
    return texelFetch(packed_w, pixel, 0)[layer];
}

// Whether the segment may meet a surface.
bool may_meet(Segment at)
{
    vec4 w = abs(at.stored), room = 2.0 * LONGEST_REACH * w;
    return any(notEqual(step(at.low, w + room) * step(w - room, vec4(at.high)), vec4(0.0)));
}
#endif

// Texel of the layers under a position; that of their edge where it is beyond.
ivec2 texel_at(vec2 place, ivec2 last)
{
    return ivec2(clamp(floor(place) - vec2(layer_first), vec2(0.0), vec2(last)));
}

// Advance to the next segment with a surface near the ray; false at the end. This cheap test is kept apart from the expensive one
// that follows, so that neighbouring rays wait less for each other.
bool walk_on(inout Walk walk, ivec2 last, out Segment at)
{
    while (true) {
        if (walk.step == walk.steps) {
            if (walk.interval == interval_count) return false;
            vec2 range = intervals[walk.interval++];
            walk.steps = clamp(int(ceil(walk.rate * (range.y - range.x))), 1, MAX_STEPS);
            walk.dw = (range.y - range.x) / float(walk.steps);
            walk.top = range.y;
            walk.step = 0;
        }
        float high = walk.top - walk.dw * float(walk.step++), low = high - walk.dw, pad = OVERLAP * walk.dw + LEAST_PAD * high;
        at.pixel = texel_at(walk.a + walk.b * (0.5 * (high + low)), last);
        at.stored = texelFetch(packed_w, at.pixel, 0);
        at.low = low - pad;
        at.high = high + pad;
        if (may_meet(at)) return true;
#ifdef MOVERS
        if (arrivals_at(at.pixel).z != 0u) return true;
#endif
    }
}

// Texel of a hit: in the pixel where the ray meets it, or where the walk found it, in the pixel under the segment's middle.
ivec3 texel_of(vec2 a, vec2 b, ivec2 last, ivec2 found, Hit hit)
{
    ivec2 there = texel_at(a + b * hit.w, last);
    float w = stored_w(there, hit.layer);
    bool same = abs(abs(w) - hit.w) <= hit.reach + UNLIKE * hit.w && (w > 0.0) == hit.opaque;
    return ivec3(same ? there : found, hit.layer);
}

// Share of the light behind a hit that it lets pass.
float passing_at(vec2 a, vec2 b, ivec2 last, ivec2 found, Hit hit)
{
    return 1.0 - opacity_of(texelFetch(radiance, texel_of(a, b, last, found, hit), 0), hit.opaque);
}

// March a ray through the layers: premultiplied radiance and coverage, composited front to back.
vec4 march(vec2 a, vec2 b)
{
    ivec2 last = layer_last;
    Walk walk = Walk(a, b, max(max(abs(b.x), abs(b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    Segment at;
    Hit hit = Hit(0.0, -1, false, 0.0);
    vec4 seen = vec4(0.0);
    float passing = 1.0;    // share of the light that what was met lets pass
    float limit = 1e30;     // surfaces in front of it are met
#ifdef SPLATS
    int plane = 0;          // next plane of splats
#endif
    while (!hit.opaque && walk_on(walk, last, at)) {
        hit = nearest_in(a, b, at, limit);
#ifdef MAY_BE_TRANSLUCENT
        while (hit.layer >= 0 && !hit.opaque) {
#ifdef SPLATS
            pass_planes(a, b, hit.w, plane, seen, passing);
#endif
            ivec3 texel = texel_of(a, b, last, at.pixel, hit);
            vec4 surface = texelFetch(radiance, texel, 0), light = passing * light_of(surface, false);
#ifdef MATTES
            note_surface(texel, light, abs(stored_w(texel.xy, texel.z)));
#endif
            seen += light;
            passing *= 1.0 - opacity_of(surface, false);
            limit = hit.w;
            hit = nearest_in(a, b, at, limit);
        }
#endif
    }
    vec4 solid;
#ifdef SPLATS
    pass_planes(a, b, hit.opaque ? hit.w : -1e30, plane, seen, passing);
#endif
    if (hit.opaque) {
        ivec3 texel = texel_of(a, b, last, at.pixel, hit);
        solid = passing * light_of(texelFetch(radiance, texel, 0), true);
#ifdef MATTES
        note_surface(texel, solid, abs(stored_w(texel.xy, texel.z)));
#endif
    } else {
        solid = passing * vec4(texelFetch(background, texel_at(a, last), 0).rgb, 0.0);
    }
    return seen + solid;
}
