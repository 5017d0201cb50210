#version 450 core
// Light of a highlight in a pixel: along the one ray that joins them through the pupil.
// in:  the highlight (plan.comp); layers (march.glsl), lens
// out: radiance, added to the picture

#include "trace/march.glsl"
#ifdef MOVERS
#include "trace/march_moving.glsl"
#endif
#include "highlights/connection.glsl"
#include "highlights/opening.glsl"
#include "highlights/passing.glsl"

flat in vec4 excess;
flat in vec4 place;

out vec4 color;

uniform ivec2 area_first;       // pixel of the picture at the corner of `color`
uniform vec3 light;             // this wavelength's share in red, green and blue

const float INVERSE_PI = 0.3183098861837907;

void main()
{
    float w = excess.w;
    PixelRays rays = rays_from(gl_FragCoord.xy + vec2(area_first));
    Joined joined = join(rays, place.xy, w);
    if (!joined.found) discard;
    float density = light_at(rays, joined.l, joined.from.weight, inverse(joined.place_from_pupil), place.w);
    if (density <= 0.0) discard;
    density *= INVERSE_PI / abs(determinant(joined.place_from_pupil));
    float share = share_past(rays.centre, on_layers(rays, joined.from, vec2(0.0)), place.z);
    color = vec4(share * density * light * excess.rgb, 0.0);
}
