// Where lens rays meet peeled layers when some surfaces of them move: as trace/march.glsl, at one moment of the shutter's opening.
// A surface that stands still is met where it was peeled. One that moves is looked for where a ray would meet it that had moved the
// other way (carried.glsl): by the motion of what may land here at this moment, then by that of what it meets there, until both
// are the same. Kyaw 2013 gathers along one velocity in the picture; here each layer has its own, and depth.

uniform int most_tries;         // more than enough; told from outside, so that no compiler writes the loops out
const int ROUNDS_OF_MOTION = 4;
const float SAME_PLACE = 0.8;   // px by which a surface may miss the ray that found it
// Kinds of surfaces searched for: still ones; the fastest and the nearest that may move into this pixel; moving ones
// that were peeled in this pixel.
const int STILL = 0, FASTEST = 1, NEAREST = 2, PASSED = 3;

// A surface that is met: `hit.w` where it was peeled, `w` at the moment; `b` of the ray relative to it, and the pixel it was found in.
struct Met { Hit hit; float w; vec2 b; ivec2 pixel; };

// A look at what moves by `mover` (m) near where that is at its w; so many rounds of it have been made.
struct Look { int sought; vec4 mover; int round; };

const Met NOTHING = Met(Hit(0.0, -1, false, 0.0), 0.0, vec2(0.0), ivec2(-9));

// Motion of a layer's surface at this moment, and 1 where it moves.
vec4 motion_at(ivec2 pixel, int layer)
{
    uvec4 stored = texelFetch(motion, ivec3(pixel, layer), 0);
    return stored.w == 0u ? vec4(0.0) : vec4(motion_in_half(stored, shutter_time >= 0.0), 1.0);
}

vec4 mover_of(uint number)
{
    int i = int(number - 1u), across = textureSize(movers, 0).x, down = textureSize(movers, 0).y;
    return texelFetch(movers, ivec3(i % across, i / across % down, i / (across * down)), 0);
}

// The stretch and the ray as what moves with a look's mover meets them.
Stretch seen_moving(vec2 a, vec2 b, Stretch at, vec4 mover, ivec2 last, out vec2 own)
{
    float away = shutter_time * mover.z;
    own = relative(a, b, shutter_time * mover.xyz);
    Stretch there;
    there.low = in_the_middle(at.low, away);
    there.high = in_the_middle(at.high, away);
    there.pixel = ivec2(clamp(floor(a + own * clamp(mover.w, there.low, there.high)), vec2(0.0), vec2(last)));
    there.stored = texelFetch(packed_w, there.pixel, 0);
    return there;
}

// Choose the next search when one has ended; false where none is left.
bool next_look(inout Look look, uvec4 arrived, vec4 passed)
{
    look.round = 0;
    ++look.sought;
    if (look.sought == FASTEST && arrived.z == 0u) look.sought = PASSED;
    if (look.sought == NEAREST && arrived.w == arrived.z) look.sought = PASSED;
    if (look.sought == FASTEST) look.mover = mover_of(arrived.z);
    if (look.sought == NEAREST) look.mover = mover_of(arrived.w);
    if (look.sought == PASSED) look.mover = passed;
    return look.sought < PASSED || look.sought == PASSED && passed.w > 0.0;
}

// Whether this is what the ray has met and passed through just before, found again from elsewhere.
bool is_met_again(Hit hit, ivec2 pixel, Met before)
{
    ivec2 off = abs(pixel - before.pixel);
    float apart = abs(hit.w - before.hit.w);
    return hit.layer == before.hit.layer && max(off.x, off.y) <= 2 && apart <= 3.0 * before.hit.reach + UNLIKE * hit.w;
}

// The nearest surface that is met in a stretch, in front of `limit` and behind what was met before.
Met nearest_met(vec2 a, vec2 b, Stretch at, float limit, Met before, ivec2 last)
{
    Met met = NOTHING;
    Look look = Look(STILL, vec4(0.0), 0);
    vec4 passed = vec4(0.0);
    uvec4 arrived = arrivals_at(at.pixel);
    vec2 own = b;
    Stretch there = at;
    for (int i = 0; i < most_tries; ++i) {
        float away = shutter_time * look.mover.z, behind = limit < 1e20 ? in_the_middle(limit, away) : limit;
        vec4 missed = vec4(0.0);
        // in Mesa 22's llvmpipe a do-while here forgets what the pixels beside each other found that leave it first
        for (int k = 0; k < most_tries; ++k) {
            Hit hit = nearest_in(a, own, there, behind);
            if (hit.layer < 0) break;
            behind = hit.w;
            vec4 found = motion_at(there.pixel, hit.layer);
            if (look.sought == STILL) {
                if (found.w == 0.0) {
                    met = Met(hit, hit.w, own, there.pixel);
                    break;
                }
                if (passed.w == 0.0) passed = vec4(found.xyz, hit.w);
                continue;
            }
            if (found.w == 0.0 || is_met_again(hit, there.pixel, before)) continue;
            vec2 its = relative(a, b, shutter_time * found.xyz), off = abs(a + its * hit.w - (vec2(there.pixel) + 0.5));
            if (max(off.x, off.y) <= SAME_PLACE) {
                float w = at_the_moment(hit.w, shutter_time * found.z);
                if (w > met.w && w < limit) met = Met(hit, w, its, there.pixel);
                break;
            }
            if (missed.w == 0.0) missed = vec4(found.xyz, hit.w);
        }
        if (missed.w > 0.0 && ++look.round < ROUNDS_OF_MOTION) look.mover = missed;
        else if (!next_look(look, arrived, passed)) break;
        there = seen_moving(a, b, at, look.mover, last, own);
    }
    return met;
}

// March a ray through moving layers: premultiplied radiance and coverage, composited front to back.
vec4 march_moving(vec2 a, vec2 b)
{
    ivec2 last = textureSize(packed_w, 0) - 1;
    Walk walk = Walk(a, b, max(max(abs(b.x), abs(b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    Stretch at;
    Met before = NOTHING;
    vec4 seen = vec4(0.0), behind = vec4(texelFetch(background, ivec2(clamp(floor(a), vec2(0.0), vec2(last))), 0).rgb, 0.0);
    float limit = 1e30;
    bool on = true;
    for (int through = 0; through < 2 * most_tries;) {
        if (on && !walk_on(walk, last, at)) break;
        Met met = nearest_met(a, b, at, limit, before, last);
        on = met.hit.layer < 0;
        if (on) continue;
        vec4 surface = radiance_at(a, met.b, last, met.pixel, met.hit);
        if (met.hit.opaque) {
            behind = vec4(surface.rgb, 1.0);
            break;
        }
        seen += (1.0 - seen.a) * surface.a * vec4(surface.rgb, 1.0);
        limit = met.w;
        before = met;
        ++through;
    }
    return seen + (1.0 - seen.a) * behind;
}
