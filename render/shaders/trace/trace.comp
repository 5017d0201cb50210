#version 450 core
// Traces lens rays through peeled layers and adds what they meet.
// in:  layers, their N-buffers and background (march.glsl); patterns, iris and lens (lens_rays.glsl)
// out: sum of weighted radiance and coverage in `sum` (premultiplied), added to what is there
// Lee, Eisemann & Seidel 2010, section 3.1. All pixels here are the layers', guard band included, where not said otherwise.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;

#include "trace/march.glsl"
#ifdef MOVERS
#include "trace/march_moving.glsl"
#endif
#include "lens/lens_rays.glsl"

uniform ivec2 first_pixel;      // of those that this dispatch works on
uniform ivec2 end_pixel;        // behind the last of them
uniform vec2 offset;            // of the picture's corner in the layers
#ifdef FOCAL_MAP
uniform sampler2D focal_map;    // w_f and the pupil's radius over the lens's own, of the picture's pixels (focal_surface.comp)
#else
uniform vec3 focus;             // w_f at the picture's pixel (x, y) is focus.x + focus.y·x + focus.z·y
#endif
uniform int first_ray;
uniform int ray_count;
uniform vec4 light;             // of this wavelength in red, green, blue and coverage, over the number of rays

const int ROUNDS = 3;
#ifdef BOUND_BY_RAYS
const int SLABS = 4;    // each asks every ray
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
// The quad that holds where each of the pixel's rays is at both ends of a range of w.
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

// Where the pixel's rays can be between two inverse depths: layer pixels, `reach` around them included.
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
    from = ivec2(floor(low));
    to = ivec2(floor(high));
}

// Narrow the range of w in which any ray of the pixel can meet a surface: the footprint of the range before bounds the next.
vec2 bound_footprint(PixelRays rays, float reach)
{
    vec2 range = range_of_all();
    ivec2 from, to;
    for (int i = 0; i < ROUNDS && range.y > 0.0; ++i) {
        footprint_between(rays, range, reach, from, to);
        range = range_over(from, to);
    }
    return range;
}

// Which bins within the range hold anything where the rays are at that depth: slab by slab, each with its own footprint.
uvec2 reachable_bins(PixelRays rays, vec2 range, float reach)
{
    vec2 all = range_of_all();
    int last = bin_of(range.y, all), first = bin_of(range.x, all);
    int slab = max(1, (last - first + SLABS) / SLABS);
    float width = (all.y - all.x) / float(BINS);
    uvec2 held = uvec2(0u);
    for (int low = first; low <= last; low += slab) {
        int high = min(low + slab - 1, last);
        ivec2 from, to;
        footprint_between(rays, all.x + width * vec2(low, high + 1), reach, from, to);
        held |= bins_over(from, to) & bits_between(low, high);
    }
    return held;
}

// Share of the light that passes the lens for this pixel, from the lens table, which is more accurate than counting a
// few rays that pass or are blocked: the radiance is scaled to it. Not where the iris is shaped and clipped, which the
// table does not know.
float known_light(float weights, float count)
{
#ifdef POLYNOMIAL_LENS
#ifdef SHAPED_IRIS
    if (row[REGION + 3] > 0.0) return 1.0;
#endif
    if (weights > 0.0) return row[LIGHT] * count / weights;
#endif
    return 1.0;
}

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + first_pixel;
    if (any(greaterThanEqual(pixel, end_pixel))) return;
    vec2 place = vec2(pixel) + 0.5;
#ifdef FOCAL_MAP
    vec2 focused = texelFetch(focal_map, pixel, 0).xy;
#else
    vec2 focused = vec2(focus.x + dot(focus.yz, place), 1.0);
#endif
    PixelRays rays = begin_pixel(pixel, place * scale + offset, axis, focused.x, focused.y);
    float reach = 0.5 * scale + 1.0;
    vec2 range = bound_footprint(rays, reach);
    run_count = 0;
    if (range.y > 0.0) find_runs(reachable_bins(rays, range, reach), range);
    vec4 total = vec4(0.0);
    float weights = 0.0;
    for (int i = 0; i < ray_count; ++i) {
        LensRay ray = lens_ray(rays, first_ray + i);
        if (ray.weight <= 0.0) continue;
        weights += ray.weight;
#ifdef MOVERS
        total += ray.weight * march_moving(ray.a, ray.b);
#else
        total += ray.weight * march(ray.a, ray.b);
#endif
    }
    total *= known_light(weights, float(ray_count));
    imageStore(sum, pixel, imageLoad(sum, pixel) + light * total);
}
