// Intersection of lens rays with peeled layers that hold moving surfaces: trace/march.glsl at one moment of the exposure.
// A still surface is met where it was peeled. A moving one is searched for by moving the ray the other way (carried.glsl): by the
// motion of a surface that may arrive here at this moment, then by the motion of the surface it meets there, until both agree.
// Kyaw 2013 gathers along one velocity in the picture; here each layer has its own velocity and depth.

uniform int most_tries;         // limit of the loops; a uniform, so that no compiler unrolls them
const int ROUNDS_OF_MOTION = 4;
const float SAME_PLACE = 0.8;   // px by which a surface may miss the ray of its search
// Kinds of surfaces searched for: still ones; the fastest and the nearest that may move into this pixel; moving ones
// that were peeled in this pixel.
const int STILL = 0, FASTEST = 1, NEAREST = 2, PASSED = 3;

// A hit: `hit.w` where it was peeled, `w` at the moment; `b` of the ray relative to it, and the pixel it was found in.
struct Met { Hit hit; float w; vec2 b; ivec2 pixel; };

// A search for surfaces that move by `mover` (xyz in m, its w); `round` counts its rounds.
struct Search { int kind; vec4 mover; int round; };

const Met NO_HIT = Met(Hit(0.0, -1, false, 0.0), 0.0, vec2(0.0), ivec2(-9));

vec4 mover_of(uint number)
{
    int i = int(number - 1u), across = textureSize(movers, 0).x, down = textureSize(movers, 0).y;
    return texelFetch(movers, ivec3(i % across, i / across % down, i / (across * down)), 0);
}

// The segment and the ray relative to a surface that moves by `mover`.
Segment segment_at_mover(vec2 a, vec2 b, Segment at, vec4 mover, ivec2 last, out vec2 own)
{
    float away = shutter_time * mover.z;
    own = relative(a, b, shutter_time * mover.xyz);
    Segment there;
    there.low = in_the_middle(at.low, away);
    there.high = in_the_middle(at.high, away);
    there.pixel = texel_at(a + own * clamp(mover.w, there.low, there.high), last);
    there.stored = texelFetch(packed_w, there.pixel, 0);
    return there;
}

// Choose the next search when one has ended; false where none is left.
bool next_search(inout Search search, uvec4 arrived, vec4 passed)
{
    search.round = 0;
    ++search.kind;
    if (search.kind == FASTEST && arrived.z == 0u) search.kind = PASSED;
    if (search.kind == NEAREST && arrived.w == arrived.z) search.kind = PASSED;
    if (search.kind == FASTEST) search.mover = mover_of(arrived.z);
    if (search.kind == NEAREST) search.mover = mover_of(arrived.w);
    if (search.kind == PASSED) search.mover = passed;
    return search.kind < PASSED || search.kind == PASSED && passed.w > 0.0;
}

// Whether this is the transparent surface that the ray met just before, found again from another pixel.
bool is_same_hit(Hit hit, ivec2 pixel, Met before)
{
    ivec2 off = abs(pixel - before.pixel);
    float apart = abs(hit.w - before.hit.w);
    return hit.layer == before.hit.layer && max(off.x, off.y) <= 2 && apart <= 3.0 * before.hit.reach + UNLIKE * hit.w;
}

// Nearest surface in a segment, in front of `limit` and behind the last hit.
Met nearest_met(vec2 a, vec2 b, Segment at, float limit, Met before, ivec2 last)
{
    Met met = NO_HIT;
    Search search = Search(STILL, vec4(0.0), 0);
    vec4 passed = vec4(0.0);
    uvec4 arrived = arrivals_at(at.pixel);
    vec2 own = b;
    Segment there = at;
    for (int i = 0; i < most_tries; ++i) {
        float away = shutter_time * search.mover.z, behind = limit < 1e20 ? in_the_middle(limit, away) : limit;
        vec4 missed = vec4(0.0);
        // in Mesa 22's llvmpipe a do-while here loses the results of pixels that leave it first
        for (int k = 0; k < most_tries; ++k) {
            Hit hit = nearest_in(a, own, there, behind);
            if (hit.layer < 0) break;
            behind = hit.w;
            vec4 found = motion_at(there.pixel, hit.layer);
            if (search.kind == STILL) {
                if (found.w == 0.0) {
                    met = Met(hit, hit.w, own, there.pixel);
                    break;
                }
                if (passed.w == 0.0) passed = vec4(found.xyz, hit.w);
                continue;
            }
            if (found.w == 0.0 || is_same_hit(hit, there.pixel, before)) continue;
            vec2 its = relative(a, b, shutter_time * found.xyz), off = abs(a + its * hit.w - (vec2(there.pixel + layer_first) + 0.5));
            if (max(off.x, off.y) <= SAME_PLACE) {
                float w = at_the_moment(hit.w, shutter_time * found.z);
                if (w > met.w && w < limit) met = Met(hit, w, its, there.pixel);
                break;
            }
            if (missed.w == 0.0) missed = vec4(found.xyz, hit.w);
        }
        if (missed.w > 0.0 && ++search.round < ROUNDS_OF_MOTION) search.mover = missed;
        else if (!next_search(search, arrived, passed)) break;
        there = segment_at_mover(a, b, at, search.mover, last, own);
    }
    return met;
}

// March a ray through moving layers: premultiplied radiance and coverage, composited front to back.
vec4 march_moving(vec2 a, vec2 b)
{
    ivec2 last = layer_last;
    Walk walk = Walk(a, b, max(max(abs(b.x), abs(b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    Segment at;
    Met before = NO_HIT;
    vec4 seen = vec4(0.0), behind = vec4(texelFetch(background, texel_at(a, last), 0).rgb, 0.0);
    float limit = 1e30, passing = 1.0;
    bool on = true;
#ifdef SPLATS
    int plane = 0;
#endif
    for (int through = 0; through < 2 * most_tries;) {
        if (on && !walk_on(walk, last, at)) break;
        Met met = nearest_met(a, b, at, limit, before, last);
        on = met.hit.layer < 0;
        if (on) continue;
#ifdef SPLATS
        pass_planes(a, b, met.w, plane, seen, passing);
#endif
        ivec3 texel = texel_of(a, met.b, last, met.pixel, met.hit);
        vec4 surface = texelFetch(radiance, texel, 0), light = light_of(surface, met.hit.opaque);
#ifdef MATTES
        float away = shutter_time * motion_at(texel.xy, texel.z).z;
        note_surface(texel, passing * light, at_the_moment(abs(stored_w(texel.xy, texel.z)), away));
#endif
        if (met.hit.opaque) {
            behind = light;
            break;
        }
        seen += passing * light;
        passing *= 1.0 - opacity_of(surface, false);
        limit = met.w;
        before = met;
        ++through;
    }
#ifdef SPLATS
    if (on) pass_planes(a, b, -1e30, plane, seen, passing);
#endif
    return seen + passing * behind;
}
