// A layer's texel as the picture's camera sees it. Both may have moved since the layers were peeled. The area is that of a surface that
// moves without turning.

#ifdef CARRIED_CAMERA
#include "layers/carried.glsl"
#ifndef LENS_RAYS
uniform vec2 axis;              // as in lens/lens_rays.glsl
uniform vec2 focal_px;
uniform mat3 camera_turn;
uniform vec3 camera_move;
#endif
const float LEAST_AHEAD = 0.02; // least depth ahead of the moment's camera, along the layers' axis, relative to that ahead of the layers' eye
#endif

// Slopes of a surface's w over a layer pixel, as they are stored.
uvec4 stored_slopes(ivec2 texel, int layer)
{
#ifdef EIGHT_LAYERS
    if (layer >= 4) return texelFetch(slopes_far, texel, 0);
#endif
    return texelFetch(slopes, texel, 0);
}

// Relative change of a surface's w over a layer pixel, to the right and down.
vec2 slope_at(ivec2 texel, int layer)
{
    uvec4 stored = stored_slopes(texel, layer);
    return vec2(unpacked_slopes(stored)[layer & 3], unpacked_slopes(stored >> 8)[layer & 3]);
}

// Greatest relative change of a surface's w within its pixel.
float reach_at(ivec2 texel, int layer)
{
    return reach_of(stored_slopes(texel, layer))[layer & 3];
}

// Position in the picture's frame, layer pixels; inverse depth seen from its camera, 0 where the texel may be behind it; area that a
// pixel of the layers has there; inverse depth on the layers.
struct Seen { vec2 place; float w; float area; float w_on_layers; };

Seen seen_texel(ivec2 texel, int layer, float w)
{
    Seen seen = Seen(vec2(texel + layer_first) + 0.5, w, 1.0, w);
#ifdef CARRIED_CAMERA
    vec3 along = vec3((seen.place - layer_axis) / layer_focal, 1.0), point = along / w;
#ifdef MOVERS
    point += shutter_time * motion_at(texel, layer).xyz;
#endif
    vec3 from = (point - camera_move) * camera_turn;
    if (point.z < nearest_m || point.z - camera_move.z < LEAST_AHEAD * point.z || from.z < nearest_m) {
        seen.w = 0.0;
        return seen;
    }
    vec2 slope = from.xy / from.z, by_texel = slope_at(texel, layer);
    vec3 by_x = (vec3(1.0 / layer_focal.x, 0.0, 0.0) - by_texel.x * along) / w * camera_turn;
    vec3 by_y = (vec3(0.0, 1.0 / layer_focal.y, 0.0) - by_texel.y * along) / w * camera_turn;
    mat2 place_by_texel = mat2(by_x.xy - slope * by_x.z, by_y.xy - slope * by_y.z);
    seen = Seen(axis + focal_px * slope, 1.0 / from.z,
                abs(determinant(place_by_texel)) * focal_px.x * focal_px.y / (from.z * from.z), 1.0 / point.z);
#endif
    return seen;
}
