#version 450 core
// Trace lens rays through peeled layers and add up the radiance of the surfaces they meet.
// in:  layers, their N-buffers and background (march.glsl); patterns, iris and lens (lens_rays.glsl)
// out: weighted radiance and coverage, added to `sum` (premultiplied); where MATTES is defined, the table of mattes.glsl
// Lee, Eisemann & Seidel 2010, section 3.1. Pixels are the layers', guard band included, unless stated otherwise.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;

#ifdef MATTES
#include "trace/mattes.glsl"
#endif
#include "trace/march.glsl"
#ifdef MOVERS
#include "trace/march_moving.glsl"
#endif
#include "lens/lens_rays.glsl"

// Tile of each work group: its first pixel, first ray and number of rays.
layout(std430, binding = 1) readonly buffer Tiles { ivec4 tiles[]; };

uniform int first_tile;         // tile of the first work group of this dispatch
uniform ivec2 end_pixel;        // one past the last pixel of the area
uniform ivec2 area_first;       // pixel of the picture that `sum` and the focal map begin with
uniform vec2 offset;            // position of the picture's corner in the layers
#ifdef FOCAL_MAP
uniform sampler2D focal_map;    // w_f and the pupil's relative radius of the picture's pixels (focal_surface.comp)
#else
uniform vec3 focus;             // w_f at the picture's pixel (x, y) is focus.x + focus.y·x + focus.z·y
#endif
uniform vec4 light;             // this wavelength's share in red, green, blue and coverage

int first_ray, ray_count;       // of this work group

const int ROUNDS = 3;
#ifdef BOUND_BY_RAYS
const int SLABS = 4;    // each slab evaluates every ray
#else
const int SLABS = 8;
#endif

#if defined(POLYNOMIAL_LENS) || !defined(BOUND_BY_RAYS)
// Closed form: all rays of the pixel pass within `radius` of `centre` at inverse depth w.
void footprint(PixelRays rays, float w, out vec2 centre, out vec2 radius)
{
#ifdef POLYNOMIAL_LENS
    float off = rays.pupil * (w - rays.w_f);
    vec2 px = focal_px * narrowing;
    centre = rays.centre + px * (row[BOUND] + row[BOUND + 2] * off) * rays.outward;
    radius = px * (row[BOUND + 1] + row[BOUND + 3] * abs(off));
#else
    centre = rays.centre;
    radius = abs(focal_px * pupil_m * rays.pupil * (w - rays.w_f));
#endif
}
#endif

#ifdef BOUND_BY_RAYS
// Quad around the pixel's rays at both ends of a range of w.
void rays_quad(PixelRays rays, vec2 range, inout vec2 low, inout vec2 high)
{
    for (int i = 0; i < ray_count; ++i) {
        LensRay ray = lens_ray(rays, first_ray + i);
        vec2 near = ray.a + ray.b * range.y, far = ray.a + ray.b * range.x;
        low = min(low, min(near, far));
        high = max(high, max(near, far));
    }
}
#endif

// Footprint of the pixel's rays between two inverse depths, in layer pixels, widened by `reach`.
void footprint_between(PixelRays rays, vec2 range, float reach, out ivec2 from, out ivec2 to)
{
    vec2 low = vec2(1e9), high = vec2(-1e9);
#ifdef BOUND_BY_RAYS
    rays_quad(rays, range, low, high);
    low -= 1.0;
    high += 1.0;
#else
    vec2 centre, radius;
    for (int end = 0; end < 2; ++end) {
        footprint(rays, range[end], centre, radius);
        low = min(low, centre - radius - reach);
        high = max(high, centre + radius + reach);
    }
#endif
    from = ivec2(floor(max(low, vec2(-1e9))));  // an int holds no larger number
    to = ivec2(floor(min(high, vec2(1e9))));
}

// Narrow the range of w in which the pixel's rays can meet surfaces: each range's footprint bounds the next range.
vec2 bound_footprint(PixelRays rays, float reach)
{
    vec2 range = w_range;
    ivec2 from, to;
    for (int i = 0; i < ROUNDS && range.y > 0.0; ++i) {
        footprint_between(rays, range, reach, from, to);
        range = range_over(from, to);
    }
    return range;
}

// Occupied bins within the range under the rays' footprint at their depth: slab by slab, each with its own footprint.
uvec2 reachable_bins(PixelRays rays, vec2 range, float reach)
{
    int last = bin_of(range.y, w_range), first = bin_of(range.x, w_range);
    int slab = max(1, (last - first + SLABS) / SLABS);
    float width = (w_range.y - w_range.x) / float(BINS);
    uvec2 occupied = uvec2(0u);
    for (int low = first; low <= last; low += slab) {
        int high = min(low + slab - 1, last);
        ivec2 from, to;
        footprint_between(rays, w_range.x + width * vec2(low, high + 1), reach, from, to);
        occupied |= bins_over(from, to) & bits_between(low, high);
    }
    return occupied;
}


// Share of the light that passes the lens for this pixel, from the lens table, which is more accurate than counting a
// few rays that pass or are blocked: the radiance is scaled to it. Not where so few rays are expected to pass that all may be
// blocked, whose light would be lost; nor where the iris is shaped and clipped, which the table does not know.
const float LEAST_PASSING = 2.0;

float light_correction(float weights, float count)
{
#ifdef POLYNOMIAL_LENS
#ifdef SHAPED_IRIS
    if (row[REGION + 3] > 0.0) return 1.0;
#endif
    float expected = row[LIGHT] * count;
    if (weights > 0.0 && expected >= LEAST_PASSING) return expected / weights;
#endif
    return 1.0;
}

void main()
{
    ivec4 tile = tiles[first_tile + int(gl_WorkGroupID.x)];
    first_ray = tile.z;
    ray_count = tile.w;
    ivec2 pixel = tile.xy + ivec2(gl_LocalInvocationID.xy);
    if (any(greaterThanEqual(pixel, end_pixel))) return;
    vec2 place = vec2(pixel) + 0.5;
#ifdef FOCAL_MAP
    vec2 focused = texelFetch(focal_map, pixel - area_first, 0).xy;
#else
    vec2 focused = vec2(focus.x + dot(focus.yz, place), 1.0);
#endif
    PixelRays rays = begin_pixel(pixel, place * scale + offset, axis, focused.x, focused.y);
    float reach = 0.5 * scale + 1.0;
    vec2 range = bound_footprint(rays, reach);
    interval_count = 0;
    if (range.y > 0.0) find_intervals(reachable_bins(rays, range, reach), range);
#ifdef MATTES
    float passing = 0.0;
    for (int i = 0; i < ray_count; ++i) passing += max(lens_ray(rays, first_ray + i).weight, 0.0);
    float correction = light_correction(passing, float(ray_count));
    load_slots(pixel - area_first);
#endif
    vec4 total = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < ray_count; ++i) {
        LensRay ray = lens_ray(rays, first_ray + i);
        if (ray.weight <= 0.0) continue;
        weights += ray.weight;
#ifdef MATTES
        ray_share = light.a * correction * ray.weight;
#ifdef DEEP
        light_share = light.rgb * correction * ray.weight;
#endif
#endif
#ifdef MOVERS
        total += ray.weight * march_moving(ray.a, ray.b);
#else
        total += ray.weight * march(ray.a, ray.b);
#endif
    }
    total *= light_correction(weights, float(ray_count));
    pixel -= area_first;
#ifdef MATTES
    store_slots(pixel);
#endif
    imageStore(sum, pixel, imageLoad(sum, pixel) + light * total);
}
