// Where surfaces are that move while the shutter is open: what has moved by `moved` (m: x right, y down, z away from the eye) lies,
// at that moment, elsewhere on the layers than where it was peeled, in the middle of that time. It goes straight from where it is
// when the shutter opens to the middle, and straight on to where it is when it closes.

#ifndef CARRIED
#define CARRIED
uniform vec2 layer_axis;    // where the view axis meets the layers
uniform vec2 layer_focal;   // their focal length in pixels
uniform float nearest_m;    // nothing nearer than this is drawn
uniform float shutter_time;        // the moment: -0.5 when the shutter opens, 0.5 when it closes

const float MOST_M = 60000.0;   // what a half holds

// Pack a surface's motion in both halves of the exposure into three words; the fourth is 1 where it moves.
uvec4 packed_motion(vec3 first, vec3 second, bool moves)
{
    first = clamp(first, vec3(-MOST_M), vec3(MOST_M));
    second = clamp(second, vec3(-MOST_M), vec3(MOST_M));
    return uvec4(packHalf2x16(first.xy), packHalf2x16(vec2(first.z, second.x)), packHalf2x16(second.yz), moves ? 1u : 0u);
}

// Its motion in one half, times two: as over the whole time, were it to go on like that.
vec3 motion_in_half(uvec4 stored, bool is_second)
{
    vec2 middle = unpackHalf2x16(stored.y);
    return 2.0 * (is_second ? vec3(middle.y, unpackHalf2x16(stored.z)) : vec3(unpackHalf2x16(stored.x), middle.x));
}

// Inverse depth in the middle of what is at w at the moment, and the other way round; `away`: how far it has moved from the eye.
float in_the_middle(float w, float away)
{
    return w / max(1.0 - away * w, w * nearest_m);
}

float at_the_moment(float w, float away)
{
    return w / max(1.0 + away * w, w * nearest_m);
}

// Where on the layers something lies that was peeled at `place` and w.
vec2 carried(vec2 place, float w, vec3 moved)
{
    vec2 slope = (place - layer_axis) / layer_focal;
    return layer_axis + layer_focal * (slope + moved.xy * w) / max(1.0 + moved.z * w, w * nearest_m);
}

// Motion over the layers, px, of a surface at `place` and w that moves by `moved` metres.
vec2 drift(vec2 place, float w, vec3 moved)
{
    return layer_focal * moved.xy * w - moved.z * w * (place - layer_axis);
}

// The ray as what has moved meets it where it was peeled: a ray's offset in the plane of the pupil is all that changes.
vec2 relative(vec2 a, vec2 b, vec3 moved)
{
    return b - layer_focal * moved.xy + moved.z * (a - layer_axis);
}
#endif
