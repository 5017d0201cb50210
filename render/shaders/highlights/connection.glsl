// The ray that joins a pixel of the picture and a texel of a layer, through the pupil.
// A pupil point l is on the unit disc, in the picture's frame; with a polynomial table in that of the pixel and the axis, as its rows.

#define LENS_RAYS
#include "lens/lens_rays.glsl"
#include "highlights/pixel_focus.glsl"

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

// The ray through a pupil point, whether or not it is open.
LensRay pupil_ray(PixelRays rays, vec2 l)
{
#if defined(POLYNOMIAL_LENS)
    return on_layers(rays, unclipped_ray(rays, l), vec2(0.0));
#else
    return on_layers(rays, LensRay(vec2(0.0), pupil_m * l, 1.0), vec2(0.0));
#endif
}

// Where a ray passes inverse depth w, layer pixels.
vec2 met_at(LensRay ray, float w)
{
    return ray.a + ray.b * w;
}
