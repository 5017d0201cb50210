// Where surfaces are that move while the shutter is open: what has moved by `moved` (m: x right, y down, z away from the eye) lies,
// at that moment, elsewhere on the layers than where it was peeled, in the middle of that time.

#ifndef CARRIED
#define CARRIED
uniform vec2 layer_axis;    // where the view axis meets the layers
uniform vec2 layer_focal;   // their focal length in pixels
uniform float since;        // the moment: -0.5 when the shutter opens, 0.5 when it closes

// Inverse depth in the middle of what is at w at the moment, and the other way round; `away`: how far it has moved from the eye.
float in_the_middle(float w, float away)
{
    return w / max(1.0 - away * w, 1e-6);
}

float at_the_moment(float w, float away)
{
    return w / max(1.0 + away * w, 1e-6);
}

// Where on the layers something lies that was peeled at `place` and w.
vec2 carried(vec2 place, float w, vec3 moved)
{
    vec2 slope = (place - layer_axis) / layer_focal;
    return layer_axis + layer_focal * (slope + moved.xy * w) / max(1.0 + moved.z * w, 1e-6);
}

// The ray as what has moved meets it where it was peeled: a ray's offset in the plane of the pupil is all that changes.
vec2 relative(vec2 a, vec2 b, vec3 moved)
{
    return b - layer_focal * moved.xy + moved.z * (a - layer_axis);
}
#endif
