// Where lens rays meet peeled layers when some surfaces of them move: as march.glsl, at one moment of the shutter's opening.
// A surface that stands still is met where it was peeled. One that moves is looked for where a ray would meet it that had moved the
// other way (carried.glsl): by the motion of what may land here at this moment, then by that of what it meets there, until both
// are the same. Kyaw 2013 gathers along one velocity in the picture; here each layer has its own, and depth.

uniform int most_tries;         // more than enough; told from outside, so that no compiler writes the loop out
const int ROUNDS_OF_MOTION = 4;
const float SAME_PLACE = 0.8;   // px by which a surface may miss the ray that found it
const int STILL = 0, LANDING = 1, PASSED = 2;   // what is looked for: what stands, what may land here, what was peeled here and moves

// A surface that is met: `hit.w` where it was peeled, `w` at the moment; `b` of the ray relative to it, and the pixel it was found in.
struct Met { Hit hit; float w; vec2 b; ivec2 pixel; };

// A look at what moves by `mover` (m) near where that is at its w: the nearest that stands, or that moves, behind `limit`.
struct Look { int sought; vec4 mover; int round; };

// The stretch and the ray as what moves with a look's mover meets them.
Stretch seen_moving(vec2 a, vec2 b, Stretch at, vec4 mover, ivec2 last, out vec2 own)
{
    float away = since * mover.z;
    own = relative(a, b, since * mover.xyz);
    Stretch there;
    there.low = in_the_middle(at.low, away);
    there.high = in_the_middle(at.high, away);
    there.pixel = clamp(ivec2(floor(a + own * clamp(mover.w, there.low, there.high))), ivec2(0), last);
    there.stored = texelFetch(packed_w, there.pixel, 0);
    return there;
}

// What to look for when a look has ended; false where nothing is left.
bool next_look(inout Look look, uint key, vec4 passed)
{
    look.round = 0;
    ++look.sought;
    if (look.sought == LANDING) {
        if (key != 0u) {
            look.mover = fastest[(key & key_mask) - 1u];
            return true;
        }
        ++look.sought;
    }
    look.mover = passed;
    return look.sought == PASSED && passed.w > 0.0;
}

// The nearest surface that is met in a stretch, in front of `limit`.
Met nearest_met(vec2 a, vec2 b, Stretch at, float limit, ivec2 last)
{
    Met met = Met(Hit(0.0, -1, false, 0.0), 0.0, b, at.pixel);
    Look look = Look(STILL, vec4(0.0), 0);
    vec4 passed = vec4(0.0);
    uint key = landing_at(at.pixel);
    vec2 own = b;
    Stretch there = at;
    for (int i = 0; i < most_tries; ++i) {
        float away = since * look.mover.z, behind = limit < 1e20 ? in_the_middle(limit, away) : limit;
        Hit hit = Hit(0.0, -1, false, 0.0);
        vec4 found = vec4(0.0);
        // in Mesa 22's llvmpipe a do-while here forgets what the pixels beside each other found that leave it first
        for (int k = 0; k < most_tries; ++k) {
            hit = nearest_in(a, own, there, behind);
            if (hit.layer < 0) break;
            found = texelFetch(motion, ivec3(there.pixel, hit.layer), 0);
            if (look.sought == STILL && found.w != 0.0 && passed.w == 0.0) passed = vec4(found.xyz, hit.w);
            if ((found.w != 0.0) != (look.sought == STILL)) break;
            behind = hit.w;
        }
        bool misses = false;
        if (hit.layer >= 0) {
            vec2 off = abs(a + relative(a, b, since * found.xyz) * hit.w - (vec2(there.pixel) + 0.5));
            misses = look.sought != STILL && max(off.x, off.y) > SAME_PLACE;
            float w = at_the_moment(hit.w, away);
            if (!misses && w > met.w) met = Met(hit, w, own, there.pixel);
            if (misses) look.mover = vec4(found.xyz, hit.w);
        }
        if (!misses || ++look.round == ROUNDS_OF_MOTION) {
            if (!next_look(look, key, passed)) break;
        }
        there = seen_moving(a, b, at, look.mover, last, own);
    }
    return met;
}

// What a ray sees: premultiplied radiance and coverage, composited front to back.
vec4 march_moving(vec2 a, vec2 b)
{
    ivec2 last = textureSize(packed_w, 0) - 1;
    Walk walk = Walk(a, b, max(max(abs(b.x), abs(b.y)), 1e-12), 0, 0, 0, 0.0, 0.0);
    Stretch at;
    vec4 seen = vec4(0.0), behind = vec4(texelFetch(background, clamp(ivec2(floor(a)), ivec2(0), last), 0).rgb, 0.0);
    float limit = 1e30;
    bool on = true;
    while (true) {
        if (on && !walk_on(walk, last, at)) break;
        Met met = nearest_met(a, b, at, limit, last);
        on = met.hit.layer < 0;
        if (on) continue;
        vec4 surface = radiance_at(a, met.b, last, met.pixel, met.hit);
        if (met.hit.opaque) {
            behind = vec4(surface.rgb, 1.0);
            break;
        }
        seen += (1.0 - seen.a) * surface.a * vec4(surface.rgb, 1.0);
        limit = met.w;
    }
    return seen + (1.0 - seen.a) * behind;
}
