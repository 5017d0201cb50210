#version 450 core
// Light of a highlight in a pixel: along the one ray that joins them through the pupil.
// in:  the highlight (plan.comp); layers (march.glsl), lens
// out: radiance, added to the picture

#include "trace/march.glsl"
#include "highlights/connection.glsl"
#include "highlights/opening.glsl"

flat in vec4 excess;
flat in uvec4 texel;
flat in uvec2 bins_in_way;

out vec4 color;

uniform vec3 light;             // this wavelength's share in red, green and blue

const float INVERSE_PI = 0.3183098861837907;

// Share of the light along a ray that what is in front of inverse depth `front` lets pass.
float share_past(LensRay ray, float front)
{
    ivec2 last = layer_last;
    interval_count = 0;
    find_intervals(bins_in_way, vec2(front, w_range.y));
    Walk walk = Walk(ray.a, ray.b, max(max(abs(ray.b.x), abs(ray.b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    Segment at;
    float share = 1.0, limit = 1e30;
    while (walk_on(walk, last, at)) {
        Hit hit = nearest_in(ray.a, ray.b, at, limit);
        while (hit.layer >= 0 && hit.w > front) {
            if (hit.opaque) return 0.0;
            share *= 1.0 - radiance_at(ray.a, ray.b, last, at.pixel, hit).a;
            limit = hit.w;
            hit = nearest_in(ray.a, ray.b, at, limit);
        }
    }
    return share;
}

void main()
{
    float w = excess.w;
    PixelRays rays = rays_from(gl_FragCoord.xy);
    Joined joined = join(rays, vec2(ivec2(texel.xy) + layer_first) + 0.5, w);
    if (!joined.found) discard;
    float density = light_at(rays, joined.l, joined.from.weight, inverse(joined.layers_from_pupil));
    if (density <= 0.0) discard;
    density *= INVERSE_PI / abs(determinant(joined.layers_from_pupil));
    LensRay ray = on_layers(rays, joined.from, vec2(0.0));
    float front = uintBitsToFloat(texel.z);
#ifdef SHARP_LAYER
    if (sharp_stops(ray.a, ray.b, front)) discard;
#endif
    float share = bins_in_way == uvec2(0u) ? 1.0 : share_past(ray, front);
    color = vec4(share * density * light * excess.rgb, 0.0);
}
