#version 450 core
// Light of a highlight in a pixel: along the one ray that joins them through the pupil.
// in:  the highlight (plan.comp); layers (march.glsl), lens
// out: radiance, added to the picture
// The pupil's edge is averaged over the pixel and the texel, boxes of `scale` and of 1 layer pixel, at nine points with a ramp each
// that has what is left of the boxes' variance.

#include "trace/march.glsl"
#include "highlights/connection.glsl"

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

// Share of the pixel and the texel whose rays pass the round pupil.
float open_share(vec2 l, mat2 pupil_from_layers)
{
    float ramp = sqrt(1.0 + scale * scale / 9.0), steepness = length(transpose(pupil_from_layers) * (l / max(length(l), 1e-6)));
    float width = ramp * steepness, share = 0.0;
    for (int i = 0; i < 9; ++i) {
        vec2 off = scale / 3.0 * (vec2(i % 3, i / 3) - 1.0);
        share += clamp(0.5 + (1.0 - length(l + pupil_from_layers * off)) / width - width / 24.0, 0.0, 1.0);
    }
    return share / 9.0;
}

void main()
{
    float w = excess.w;
    vec2 q = vec2(ivec2(texel.xy) + layer_first) + 0.5;
    PixelRays rays = rays_from(gl_FragCoord.xy);
    vec2 middle = met_at(pupil_ray(rays, vec2(0.0)), w);
    mat2 layers_from_pupil = mat2(met_at(pupil_ray(rays, vec2(1.0, 0.0)), w) - middle, met_at(pupil_ray(rays, vec2(0.0, 1.0)), w) - middle);
    float area = abs(determinant(layers_from_pupil));
    if (!(area > 1e-6)) discard;
    mat2 pupil_from_layers = inverse(layers_from_pupil);
    vec2 l = pupil_from_layers * (q - middle);

    float density = open_share(l, pupil_from_layers);
    if (density <= 0.0) discard;
    LensRay ray = pupil_ray(rays, l);
    float front = uintBitsToFloat(texel.z);
#ifdef SHARP_LAYER
    if (sharp_stops(ray.a, ray.b, front)) discard;
#endif
    float share = bins_in_way == uvec2(0u) ? 1.0 : share_past(ray, front);
    color = vec4(share * density * INVERSE_PI / area * light * excess.rgb, 0.0);
}
