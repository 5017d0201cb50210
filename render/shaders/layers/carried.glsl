// Positions of surfaces that move while the shutter is open. A surface that has moved by `moved` (m: x right, y down, z away from
// the eye) at a moment lies elsewhere on the layers than where it was peeled, in the middle of the exposure. It moves straight from
// its position as the shutter opens to that in the middle, and straight on to that as it closes.

#ifndef CARRIED
#define CARRIED
uniform vec2 layer_axis;    // pixel where the view axis meets the layers
uniform vec2 layer_focal;   // the layers' focal length in pixels
uniform float nearest_m;    // near clipping distance
uniform float shutter_time; // -0.5 as the shutter opens, 0.5 as it closes

const float MOST_M = 60000.0;   // range of a half float

// Pack a surface's motion in both halves of the exposure into three words; the fourth is 1 where it moves.
uvec4 packed_motion(vec3 first, vec3 second, bool moves)
{
    first = clamp(first, vec3(-MOST_M), vec3(MOST_M));
    second = clamp(second, vec3(-MOST_M), vec3(MOST_M));
    return uvec4(packHalf2x16(first.xy), packHalf2x16(vec2(first.z, second.x)), packHalf2x16(second.yz), moves ? 1u : 0u);
}

// Motion in one half of the exposure, extrapolated to the whole of it.
vec3 motion_in_half(uvec4 stored, bool is_second)
{
    vec2 middle = unpackHalf2x16(stored.y);
    return 2.0 * (is_second ? vec3(middle.y, unpackHalf2x16(stored.z)) : vec3(unpackHalf2x16(stored.x), middle.x));
}

// Inverse depth in the middle from that at the moment, and the reverse; `away`: distance moved away from the eye, m.
float in_the_middle(float w, float away)
{
    return w / max(1.0 - away * w, w * nearest_m);
}

float at_the_moment(float w, float away)
{
    return w / max(1.0 + away * w, w * nearest_m);
}

// Position on the layers, at the moment, of a surface peeled at `place` and w.
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

// The ray relative to a moved surface: only the ray's offset in the plane of the pupil changes.
vec2 relative(vec2 a, vec2 b, vec3 moved)
{
    return b - layer_focal * moved.xy + moved.z * (a - layer_axis);
}
#endif
