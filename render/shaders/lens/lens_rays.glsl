// Rays of a pixel: pattern, iris and lens table in; lines in (layer pixel, inverse depth) out.
// Vectors are in the picture's frame: x right, y down; slopes are of object space (m of x per m of depth).

#ifdef POLYNOMIAL_LENS
#include "lens/lens_polynomial.glsl"
#endif

// Points of all patterns, ray after ray, in rows of POINTS_ACROSS texels. xy: on the unit disc; zw: on the sensor, in pixels from the
// pixel's centre, y down. With a shaped iris the next texel holds the point on the stop. A texture, since Mesa's CPU rasteriser
// reads storage buffers number by number.
uniform sampler2D ray_points;
layout(std430, binding = 7) readonly buffer Mask { int pattern_mask[]; };       // 64 x 64
#ifdef SHAPED_IRIS
uniform sampler2D iris_image;   // transmission over the square around the stop, relative to its mean on the disc
#endif
#ifdef GRID_LENS
uniform sampler2DArray grid_rays;    // slope error and pupil point (m) over pupil x and y; a slice for each field point
uniform sampler2DArray grid_light;   // weight, clearance (below 0 open)
uniform ivec2 grid_fields;           // field points across and down
uniform vec2 grid_slope;             // field of the outermost points
#endif

uniform int patterns;           // number of patterns; 1 where all pixels have the same
uniform vec2 axis;              // layer pixel on the view axis
uniform vec2 focal_px;          // focal length of the layers, or of this moment's camera at their resolution
uniform vec2 pupil_m;           // half axes of the pupil of a lens without a table
uniform vec2 narrowing;         // factors on a table's rays: 1 over the anamorphic squeeze, and 1
uniform float scale;            // layer pixels per picture pixel
#ifdef CARRIED_CAMERA
#include "layers/carried.glsl"
uniform mat3 camera_turn;       // rotation from this moment's axes to those of the layers: x right, y down, z ahead
uniform vec3 camera_move;       // position of the pupil's centre in the layers' axes, m
#endif

struct PixelRays {
    vec2 centre;        // in layer pixels
    vec2 slope;         // slope of the ideal chief ray
    vec2 outward;       // unit vector from the axis to the pixel
    float w_f;
    float pupil;        // radius of the pupil relative to the lens's own
    int pattern;
};

struct LensRay { vec2 a; vec2 b; float weight; };

// Rays of the field at `centre`, without a pattern.
PixelRays begin_field(vec2 centre, vec2 axis, float w_f, float pupil)
{
    PixelRays rays;
    rays.centre = centre;
    rays.slope = (centre - axis) / focal_px;
    float height = length(rays.slope);
    rays.outward = height > 1e-9 ? rays.slope / height : vec2(1.0, 0.0);
    rays.w_f = w_f;
    rays.pupil = pupil;
    rays.pattern = 0;
#ifdef POLYNOMIAL_LENS
    load_row(height);
#endif
    return rays;
}

PixelRays begin_pixel(ivec2 pixel, vec2 centre, vec2 axis, float w_f, float pupil)
{
    PixelRays rays = begin_field(centre, axis, w_f, pupil);
    if (patterns > 1) rays.pattern = pattern_mask[(pixel.y & 63) * 64 + (pixel.x & 63)];
    return rays;
}

#ifdef POLYNOMIAL_LENS
// Coordinates of a point along and across the plane of pixel and axis.
vec2 in_plane(PixelRays rays, vec2 point)
{
    return vec2(dot(point, rays.outward), dot(point, vec2(-rays.outward.y, rays.outward.x)));
}
#endif

#ifdef POLYNOMIAL_LENS
// Ray through a point of the disc, whether or not a rim blocks it.
LensRay unclipped_ray(PixelRays rays, vec2 disc)
{
    vec2 along = rays.outward, across = vec2(-along.y, along.x);
    float x = disc.x, y = disc.y, y2 = y * y;
    return LensRay(slope_t(x, y2) * along + y * slope_s(x, y2) * across, pupil_t(x, y2) * along + y * pupil_s(x, y2) * across,
                   even2(WEIGHT, x, y2));
}

// `disc` is a point of the whole disc, `stop` one of the iris's opening, both along and across the plane of pixel and axis.
LensRay through_lens(PixelRays rays, vec2 stop, vec2 disc)
{
    bool clipped = row[REGION + 3] > 0.0;  // clipped by a rim other than the stop's
    if (!clipped) disc = stop;
    LensRay ray = unclipped_ray(rays, disc);
    if (clipped) {
        float x = disc.x, y = disc.y, y2 = y * y;
        vec2 at = vec2(row[REGION] + row[REGION + 1] * x, row[REGION + 2] * y);
        if (dot(at, at) > 1.0 || even4(FRONT_RIM, x, y2) > 0.0 || even4(REAR_RIM, x, y2) > 0.0) ray.weight = 0.0;
#ifdef SHAPED_IRIS
        vec2 along = rays.outward, on_stop = at.x * along + at.y * vec2(-along.y, along.x);
        ray.weight *= textureLod(iris_image, 0.5 + 0.5 * on_stop, 0.0).r;
#endif
    }
    return ray;
}
#endif

#ifdef GRID_LENS
// Between field points a ray is the blend of the passing rays of the four points around. It passes where their blended clearance is
// at most 0, which is so only where one of them passes.
LensRay through_lens(PixelRays rays, vec2 stop)
{
    vec2 last = vec2(grid_fields - 1);
#ifdef GRID_MIRRORED
    vec2 mirror = vec2(rays.slope.x < 0.0 ? -1.0 : 1.0, rays.slope.y < 0.0 ? -1.0 : 1.0);
    stop *= mirror;
    vec2 at = min(abs(rays.slope) / grid_slope * last, last);
#else
    vec2 at = clamp((0.5 + 0.5 * rays.slope / grid_slope) * last, vec2(0.0), last);
#endif
    ivec2 low = min(ivec2(at), grid_fields - 2);
    vec2 part = at - vec2(low);
    LensRay blend = LensRay(vec2(0.0), vec2(0.0), 0.0);
    float clearance = 0.0, passing = 0.0;
    for (int i = 0; i < 4; ++i) {
        ivec2 step = ivec2(i & 1, i >> 1);
        vec2 near = mix(1.0 - part, part, vec2(step));
        float share = near.x * near.y;
        ivec2 field = low + step;
        vec3 place = vec3(0.5 + 0.5 * stop * GRID_INSET, float(field.y * grid_fields.x + field.x));
        vec2 light = textureLod(grid_light, place, 0.0).xy;
        clearance += share * light.y;
        if (light.y > 0.0) continue;
        vec4 found = textureLod(grid_rays, place, 0.0);
        blend.a += share * found.xy;
        blend.b += share * found.zw;
        blend.weight += share * light.x;
        passing += share;
    }
    if (clearance > 0.0 || passing == 0.0) return LensRay(vec2(0.0), vec2(0.0), 0.0);
#ifdef GRID_MIRRORED
    blend.a *= mirror;
    blend.b *= mirror;
#endif
    return LensRay(blend.a / passing, blend.b / passing, blend.weight / passing);
}
#endif

#ifdef CARRIED_CAMERA
// Transform a ray of a camera that has moved since the layers were peeled into the layers' frame: straight lines stay lines.
LensRay from_where_the_camera_is(LensRay ray)
{
    vec3 along = camera_turn * vec3((ray.a - axis) / focal_px, 1.0);
    vec3 origin = camera_turn * vec3(ray.b / focal_px, 0.0) + camera_move;
    if (along.z < 1e-4) return LensRay(vec2(-1e6), vec2(0.0), ray.weight);  // it points backward: use the layers' edge
    vec2 slope = along.xy / along.z;
    return LensRay(layer_axis + layer_focal * slope, layer_focal * (origin.xy - origin.z * slope), ray.weight);
}
#endif

// Ray through a point of the pupil as a line seen from the picture's camera; `from` is its table's, or its pupil point alone.
LensRay on_picture(PixelRays rays, LensRay from, vec2 jitter)
{
    LensRay ray = from;
#if defined(POLYNOMIAL_LENS) || defined(GRID_LENS)
    ray.a *= narrowing;
    ray.b *= narrowing;
#endif
    ray.b *= rays.pupil * focal_px;
    ray.a = rays.centre + scale * jitter + focal_px * ray.a - ray.b * rays.w_f;
    return ray;
}

// The same ray as a line on the layers.
LensRay on_layers(PixelRays rays, LensRay from, vec2 jitter)
{
    LensRay ray = on_picture(rays, from, jitter);
#ifdef CARRIED_CAMERA
    return from_where_the_camera_is(ray);
#else
    return ray;
#endif
}

LensRay lens_ray(PixelRays rays, int i)
{
    int number = i * patterns + rays.pattern;
#ifdef SHAPED_IRIS
    number *= 2;
#endif
    ivec2 texel = ivec2(number % POINTS_ACROSS, number / POINTS_ACROSS);
    vec4 point = texelFetch(ray_points, texel, 0);
    vec2 disc = point.xy, stop = disc;
#ifdef SHAPED_IRIS
    stop = texelFetch(ray_points, texel + ivec2(1, 0), 0).xy;
#endif
#ifdef POLYNOMIAL_LENS
    disc = in_plane(rays, disc);
    stop = in_plane(rays, stop);
#endif
#if defined(POLYNOMIAL_LENS)
    LensRay ray = through_lens(rays, stop, disc);
#elif defined(GRID_LENS)
    LensRay ray = through_lens(rays, stop);
#else
    LensRay ray = LensRay(vec2(0.0), pupil_m * stop, 1.0);
#endif
    return on_layers(rays, ray, point.zw);
}
