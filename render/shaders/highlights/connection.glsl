// The ray that joins a pixel of the picture and a texel of a layer, through the pupil. Both are in the picture's frame, in layer pixels: on
// the layers themselves, unless the camera has moved since they were peeled.
// A pupil point l is on the unit disc, in the picture's frame; with a polynomial table in that of the pixel and the axis, as its rows.

#define LENS_RAYS
#include "lens/lens_rays.glsl"
#include "highlights/pixel_focus.glsl"

const float PUPIL_STEP = 0.02;  // of the differences that are taken for derivatives
#ifdef GRID_LENS
const float RIM = 1.0 - PUPIL_STEP;  // beyond the disc rays may be blocked
#else
const float RIM = 1.0;
#endif
const int JOIN_ROUNDS = 8;
const float NEAR_PX = 0.05;     // layer pixels; the next step of Newton's method is far smaller

uniform int probes;             // 5; not a constant, so that compilers keep the loop: unrolled, it takes a minute to compile

// Rays of the picture's pixel at `place`, pixels.
PixelRays rays_from(vec2 place)
{
#ifdef FOCAL_MAP
    vec2 focused = focus_at(place);
#else
    vec2 focused = focus_at(floor(place) + 0.5);
#endif
    return begin_field(place * scale + offset, axis, focused.x, focused.y);
}

// What the lens does to the ray through a pupil point, whether or not it is open; with a grid, weight 0 where it is not.
LensRay table_ray(PixelRays rays, vec2 l)
{
#if defined(POLYNOMIAL_LENS)
    return unclipped_ray(rays, l);
#elif defined(GRID_LENS)
    return through_lens(rays, l);
#else
    return LensRay(vec2(0.0), pupil_m * l, 1.0);
#endif
}

// Where a ray passes inverse depth w, layer pixels.
vec2 met_at(LensRay ray, float w)
{
    return ray.a + ray.b * w;
}

// The same of a ray from the table, counted from the pixel's ideal chief ray: small numbers, whose differences are accurate.
vec2 met_beside(PixelRays rays, LensRay from, float w)
{
    vec2 off = focal_px * (from.a + rays.pupil * (w - rays.w_f) * from.b);
#if defined(POLYNOMIAL_LENS) || defined(GRID_LENS)
    off *= narrowing;
#endif
    return off;
}

// A ray from the table, where it passes inverse depth w beside the chief ray, and the derivative of that place by the pupil point.
struct Landing { LensRay from; vec2 place; mat2 by_pupil; };

Landing land(PixelRays rays, vec2 l, float w)
{
    Landing landing;
#if defined(POLYNOMIAL_LENS) || defined(GRID_LENS)
    vec2 by_x = vec2(0.0), by_y = vec2(0.0);
    for (int i = 0; i < probes; ++i) {  // the point itself, and its neighbours along x and y
        vec2 way = (2.0 * float(i & 1) - 1.0) * vec2(float(i == 1 || i == 2), float(i > 2));
        LensRay from = table_ray(rays, l + PUPIL_STEP * way);
        vec2 place = met_beside(rays, from, w);
        by_x += way.x * place;
        by_y += way.y * place;
        if (i == 0) {
            landing.from = from;
            landing.place = place;
        }
    }
    landing.by_pupil = mat2(by_x, by_y) / (2.0 * PUPIL_STEP);
#else
    vec2 size = focal_px * rays.pupil * (w - rays.w_f) * pupil_m;
    landing = Landing(table_ray(rays, l), size * l, mat2(size.x, 0.0, 0.0, size.y));
#endif
    return landing;
}

// The joining ray from the table, its pupil point, and the derivative, by that point, of the place that the ray passes.
struct Joined { bool found; LensRay from; vec2 l; mat2 place_from_pupil; };

// Find the ray of a pixel that passes place q at inverse depth w by Newton's method. Beyond the disc the lens is continued as it
// is at the rim, and the ray is that of the rim.
Joined join(PixelRays rays, vec2 q, float w)
{
    Joined joined;
    joined.found = false;
    vec2 wanted = q - rays.centre, on = vec2(0.0);
    for (int round = 0; round < JOIN_ROUNDS && !joined.found; ++round) {
        Landing landing = land(rays, on, w);
        joined.place_from_pupil = landing.by_pupil;
        joined.from = landing.from;
        if (!(abs(determinant(landing.by_pupil)) > 1e-6)) break;
        joined.l = on + inverse(landing.by_pupil) * (wanted - landing.place);
#if defined(POLYNOMIAL_LENS) || defined(GRID_LENS)
        vec2 next = joined.l / max(1.0, length(joined.l) / RIM), change = landing.by_pupil * (next - on);
        on = next;
        joined.found = max(abs(change.x), abs(change.y)) < NEAR_PX;
#else
        joined.from = table_ray(rays, joined.l / max(1.0, length(joined.l)));
        joined.found = true;
#endif
    }
    return joined;
}
