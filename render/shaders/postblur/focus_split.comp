#version 450 core
// Split each pixel's surfaces into a near field in front of the focus and a far field in it or behind, with their
// radii.
// in:  peeled layers (radiance, w; 0 empty, negative partly transparent) and their background, seen by the picture's own pixels;
//      the focus of each pixel: a plane, or a map; where SPLATS is defined, planes of splats between the layers
// out: `near`, `far`: radiance premultiplied by opacity; `radii`: of near and far in pixels
// Circle-of-confusion pass of Moersch & Hamilton 2014 (section 3.2.1), for two surfaces per pixel: where a blurred near surface
// lets light through, the layers hold the surface behind it.

#include "layers/coverage.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D near;
layout(rgba32f, binding = 1) uniform writeonly image2D far;
layout(rg32f, binding = 2) uniform writeonly image2D radii;

uniform sampler2D packed_w;         // of layers 0 to 3
uniform sampler2D packed_w_far;     // of layers 4 to 7, if any
uniform sampler2DArray radiance;
uniform sampler2D background;
uniform sampler2D focal_map;        // w_f and the pupil's radius over the lens's own
uniform bool is_mapped;
uniform vec3 focus;                 // w_f at the pixel (x, y) is focus.x + focus.y·x + focus.z·y
uniform float pupil_px;             // radius of the entrance pupil times the focal length, px·m
uniform float most_px;              // bound to which radii are clamped
uniform int layers;

const float OPAQUE = 0.999;

float stored_w(ivec2 pixel, int layer)
{
    return layer < 4 ? texelFetch(packed_w, pixel, 0)[layer] : texelFetch(packed_w_far, pixel, 0)[layer - 4];
}

vec4 front = vec4(0.0), between = vec4(0.0), back = vec4(0.0);
float front_px = 0.0, between_px = 0.0, back_px;

#ifdef SPLATS
#include "trace/splat_planes.glsl"

// Radius of a field behind whose first part another one is added: the mean, by what each covers.
float blended(float radius, vec4 field, vec4 light, float added)
{
    float more = (1.0 - field.a) * light.a;
    return more > 0.0 ? mix(radius, added, more / (field.a + more)) : radius;
}
#else
// Radius of a field: that of its first part.
float blended(float radius, vec4 field, vec4 light, float added)
{
    return field.a == 0.0 ? added : radius;
}
#endif

// Add what lies behind all that was added so far: premultiplied light, and its radius, positive in front of the focus.
void add(vec4 light, float radius)
{
    if (radius > 0.0 && front.a < OPAQUE) {
        front_px = blended(front_px, front, light, radius);
        front += (1.0 - front.a) * light;
    } else if (radius > 0.5 * front_px) {
        // nearly as near as the surface in front of it, and hidden where that one is transparent
        between_px = blended(between_px, between, light, radius);
        between += (1.0 - between.a) * light;
    } else {
        back_px = blended(back_px, back, light, abs(radius));
        back += (1.0 - back.a) * light;
    }
}

#ifdef SPLATS
// Add the planes of splats in front of w, from the next one on.
void add_planes(ivec2 pixel, float w, float focus_w, float reach, inout int plane)
{
    for (; plane < splat_count && splat_places[plane].y > w && back.a < OPAQUE; ++plane) {
        vec2 at = (vec2(pixel) + 0.5 - splat_corner) * splat_scale;
        add(textureLod(splat_planes, vec3(at, float(plane)), 0.0), reach * (splat_places[plane].x - focus_w));
    }
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(near)))) return;
    vec2 place = vec2(pixel) + 0.5;
    vec2 focused = is_mapped ? texelFetch(focal_map, pixel, 0).xy : vec2(focus.x + dot(focus.yz, place), 1.0);
    float reach = pupil_px * focused.y;
    back_px = reach * focused.x;
#ifdef SPLATS
    int plane = 0;
#endif
    for (int layer = 0; layer < layers && back.a < OPAQUE; ++layer) {
        float w = stored_w(pixel, layer);
        if (w == 0.0) break;
#ifdef SPLATS
        add_planes(pixel, abs(w), focused.x, reach, plane);
#endif
        vec4 surface = texelFetch(radiance, ivec3(pixel, layer), 0);
        // a holdout is a black surface here
        add(vec4(surface.rgb, 1.0) * opacity_of(surface, w > 0.0), reach * (abs(w) - focused.x));
    }
#ifdef SPLATS
    add_planes(pixel, -1e30, focused.x, reach, plane);
#endif
    if (back.a == 0.0 && between.a > 0.0) {
        back = between;
        back_px = between_px;
    }
    // where a near surface hides all that the layers hold, the background is no more likely than the surroundings
    if (front.a < OPAQUE || back.a > 0.0) back += (1.0 - back.a) * vec4(texelFetch(background, pixel, 0).rgb, 1.0);
    imageStore(near, pixel, front);
    imageStore(far, pixel, back);
    imageStore(radii, pixel, vec4(min(front_px, most_px), min(abs(back_px), most_px), 0.0, 0.0));
}
