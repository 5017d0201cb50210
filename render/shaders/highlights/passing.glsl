// Share of the light along a ray that what is in front of inverse depth `front` lets pass; `bins`: those that may hold something there.

float share_past(LensRay ray, float front, uvec2 bins)
{
    if (bins == uvec2(0u)) return 1.0;
    ivec2 last = layer_last;
    interval_count = 0;
    find_intervals(bins, vec2(front, w_range.y));
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
