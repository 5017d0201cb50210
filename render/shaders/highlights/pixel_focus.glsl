// Focus of a pixel of the picture: w_f in 1/m, and the pupil's radius relative to the lens's own.

uniform vec2 offset;            // position of the picture's corner in the layers
#ifdef FOCAL_MAP
uniform sampler2D focal_map;    // both, for the picture's pixels (focal_surface.comp)
#else
uniform vec3 focus;             // w_f at the picture's pixel (x, y) is focus.x + focus.y·x + focus.z·y
#endif
#ifndef LENS_RAYS
uniform float scale;            // layer pixels per picture pixel
#endif

// `place`: position in the picture, pixels; one outside has the focus of the edge.
vec2 focus_at(vec2 place)
{
#ifdef FOCAL_MAP
    return texelFetch(focal_map, clamp(ivec2(floor(place)), ivec2(0), textureSize(focal_map, 0) - 1), 0).xy;
#else
    return vec2(focus.x + dot(focus.yz, place), 1.0);
#endif
}
