// Share of the light along a ray that what is in front of the highlight lets pass.

const int PASSING_SLABS = 4;

// Occupied bins from inverse depth `front` on along a ray of the pixel at `centre`: slab by slab.
uvec2 bins_along(vec2 centre, LensRay ray, float front)
{
    int first = bin_of(front, w_range), slab = max(1, (BINS - 1 - first + PASSING_SLABS) / PASSING_SLABS);
    float width = (w_range.y - w_range.x) / float(BINS);
    uvec2 occupied = uvec2(0u);
    for (int low = first; low < BINS; low += slab) {
        int high = min(low + slab, BINS);
        vec2 near = ray.a + ray.b * (w_range.x + width * float(high));
        vec2 far = ray.a + ray.b * max(front, w_range.x + width * float(low));
        vec4 box = square_toward(centre, min(near, far) - 1.0, max(near, far) + 1.0);
        occupied |= bins_over(ivec2(floor(box.xy)), ivec2(floor(box.zw))) & bits_between(low, high - 1);
    }
    return occupied;
}

#ifdef MOVERS
// Share that surfaces met beyond `front` let pass, at this moment.
float share_along(LensRay ray, Walk walk, ivec2 last, float front)
{
    Segment at;
    Met before = NO_HIT;
    float share = 1.0, limit = 1e30;
    bool on = true;
    for (int through = 0; through < 2 * most_tries;) {
        if (on && !walk_on(walk, last, at)) break;
        Met met = nearest_met(ray.a, ray.b, at, limit, before, last);
        on = met.hit.layer < 0 || met.w <= front;
        if (on) continue;
        if (met.hit.opaque) return 0.0;
        share *= passing_at(ray.a, met.b, last, met.pixel, met.hit);
        limit = met.w;
        before = met;
        ++through;
    }
    return share;
}
#else
// Share that surfaces met beyond `front` let pass.
float share_along(LensRay ray, Walk walk, ivec2 last, float front)
{
    Segment at;
    float share = 1.0, limit = 1e30;
    while (walk_on(walk, last, at)) {
        Hit hit = nearest_in(ray.a, ray.b, at, limit);
        while (hit.layer >= 0 && hit.w > front) {
            if (hit.opaque) return 0.0;
            share *= passing_at(ray.a, ray.b, last, at.pixel, hit);
            limit = hit.w;
            hit = nearest_in(ray.a, ray.b, at, limit);
        }
    }
    return share;
}
#endif

// `centre`: the pixel's, in the picture's frame. Where the camera has moved it is not that of the layers, which does no harm:
// `square_toward` holds the ray's box for any centre. `front`: inverse depth from which on surfaces are in the way.
float share_past(vec2 centre, LensRay ray, float front)
{
    if (front >= w_range.y) return 1.0;
    uvec2 bins = bins_along(centre, ray, front);
    if (bins == uvec2(0u)) return 1.0;
    interval_count = 0;
    find_intervals(bins, vec2(front, w_range.y));
    Walk walk = Walk(ray.a, ray.b, max(max(abs(ray.b.x), abs(ray.b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    return share_along(ray, walk, layer_last, front);
}
