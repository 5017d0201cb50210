#version 450 core
// Scatter the light of highlights whose blurred image is uneven or folds: each cell of the pupil sends its share of the light to the
// pixels that its image covers, so that the sum is right wherever the images of cells lie.
// in:  highlights, the highlight of each cell; layers (march.glsl), lens
// out: `sums`, in units of 1/unit: for red, green and blue of each pixel the low and the high half of an integer, whose value does not
//      depend on the order of additions

layout(local_size_x = 64) in;

#include "trace/march.glsl"
#ifdef MOVERS
#include "trace/march_moving.glsl"
#endif
#include "highlights/connection.glsl"
#include "highlights/opening.glsl"
#include "highlights/passing.glsl"

struct Highlight {
    vec4 excess;        // radiance times opacity times area (layer pixels²); w seen from the picture's camera (1/m)
    vec4 place;         // in the picture's frame; inverse depth on the layers from which on surfaces are in the way; side, layer pixels
    vec2 middle;        // of its blurred image, picture pixels
    uint first_cell;
    uint cells;         // across and down
};
layout(std430, binding = 0) readonly buffer Highlights { Highlight highlights[]; };
layout(std430, binding = 1) readonly buffer Owners { uint owners[]; };
layout(std430, binding = 2) buffer Sums { uint sums[]; };
#ifdef SHAPED_IRIS
layout(std430, binding = 6) readonly buffer Openings { float openings[]; };  // of each cell: the iris's mean transmission
#endif

uniform int count;              // cells
uniform ivec2 first_pixel;      // of the picture in `sums`
uniform ivec2 end_pixel;        // one past the last
uniform vec3 light;             // this wavelength's share in red, green and blue
uniform float unit;
uniform int solutions;          // 4; not a constant, as `probes`

const float QUARTER_TURN = 0.7853981633974483;  // of the square's corner, half of a right angle
const float LEAST_STRETCH = 0.1;    // of the layers over the picture, relative to the mean
const float LEAST_WIDTH = 0.05, MOST_WIDTH = 256.0;  // of a cell's image, picture pixels
const float MOST_UNITS = 4294967040.0;  // in an addition

// Point of the unit disc for one of the square from -1 to 1: equal areas have equal images (Shirley & Chiu 1997).
vec2 on_disc(vec2 at)
{
    if (abs(at.x) > abs(at.y)) {
        float angle = QUARTER_TURN * at.y / at.x;
        return at.x * vec2(cos(angle), sin(angle));
    }
    float angle = at.y != 0.0 ? QUARTER_TURN * at.x / at.y : 0.0;
    return at.y * vec2(sin(angle), cos(angle));
}

// A point of the unit disc in the picture's frame as one of the pupil, which polynomial tables have in the plane of pixel and axis.
vec2 pupil_point(PixelRays rays, vec2 disc)
{
#ifdef POLYNOMIAL_LENS
    return in_plane(rays, disc);
#else
    return disc;
#endif
}

// Share of two boxes' convolution, around 0 and of these widths, that is below x.
float share_below(float x, float wide, float narrow)
{
    float far = 0.5 * (wide + narrow), near = 0.5 * abs(wide - narrow);
    vec4 past = max(x + vec4(far, near, -near, -far), 0.0);
    return dot(past * past, vec4(1.0, -1.0, -1.0, 1.0)) / (2.0 * wide * narrow);
}

void add(int at, float value)
{
    uint more = uint(clamp(value * unit + 0.5, 0.0, MOST_UNITS));
    if (more == 0u) return;
    uint before = atomicAdd(sums[at], more);
    if (before + more < before) atomicAdd(sums[at + 1], 1u);
}

// Add light, evenly over a box of a place and width, the image of the highlight itself a box of width `own` too, to the pixels.
void splat(vec3 color, vec2 place, vec2 width, float own)
{
    vec2 reach = 0.5 * (width + own);
    ivec2 first = max(ivec2(floor(place - reach)), first_pixel);
    ivec2 last = min(ivec2(floor(place + reach)), end_pixel - 1);
    for (int y = first.y; y <= last.y; ++y) {
        float above = float(y) - place.y;
        float down = share_below(above + 1.0, width.y, own) - share_below(above, width.y, own);
        for (int x = first.x; x <= last.x; ++x) {
            float before = float(x) - place.x;
            float share = down * (share_below(before + 1.0, width.x, own) - share_below(before, width.x, own));
            int at = 6 * ((y - first_pixel.y) * (end_pixel.x - first_pixel.x) + x - first_pixel.x);
            add(at, share * color.r);
            add(at + 2, share * color.g);
            add(at + 4, share * color.b);
        }
    }
}

void main()
{
    int cell = int(gl_GlobalInvocationID.x);
    if (cell >= count) return;
    Highlight from = highlights[owners[cell]];
    uint number = uint(cell) - from.first_cell;
    float w = from.excess.w, step = 2.0 / float(from.cells);
    vec2 at = (vec2(number % from.cells, number / from.cells) + 0.5) * step - 1.0, disc = on_disc(at);
    vec2 q = from.place.xy;

    // the place in the picture whose ray through the cell's centre meets the texel: a first estimate, then a step of Newton's method
    vec2 place = from.middle, miss = vec2(0.0);
    mat2 by_place = mat2(0.0);
    for (int i = 0; i < solutions; ++i) {
        PixelRays rays = rays_from(place + vec2(i == 2, i == 3));
        LensRay ray = table_ray(rays, pupil_point(rays, disc));
        vec2 missed = q - rays.centre - met_beside(rays, ray, w);
        if (ray.weight <= 0.0) return;
        if (i == 0) place += missed / scale;
        else if (i == 1) miss = missed;
        else by_place[i - 2] = miss - missed;
    }
    float stretch = determinant(by_place);
    if (!(stretch > LEAST_STRETCH * scale * scale)) return;
    mat2 by_layers = inverse(by_place);
    place += by_layers * miss;

    // the cell's image, from the middles of its edges
    PixelRays rays = rays_from(place);
    LensRay ray = LensRay(vec2(0.0), vec2(0.0), 0.0);
    vec2 centre = vec2(0.0);
    mat2 layers_from_cell = mat2(0.0);
    mat2 pupil_from_cell = mat2(0.0);
    for (int i = 0; i < probes; ++i) {
        float way = 2.0 * float(i & 1) - 1.0, along_x = float(i == 1 || i == 2), along_y = float(i > 2);
        vec2 l = pupil_point(rays, on_disc(at + 0.5 * step * way * vec2(along_x, along_y)));
        LensRay near = table_ray(rays, l);
        if (i == 0) {
            ray = near;
            centre = met_beside(rays, ray, w);
            if (ray.weight <= 0.0) return;
        }
        vec2 beside = near.weight > 0.0 ? met_beside(rays, near, w) - centre : vec2(0.0);  // a grid's blocked rays are nowhere
        layers_from_cell += way * mat2(along_x * beside, along_y * beside);
        pupil_from_cell += way * mat2(along_x * l, along_y * l);
    }
    mat2 place_from_cell = by_layers * layers_from_cell;
    vec2 width = max(abs(place_from_cell[0]) + abs(place_from_cell[1]), LEAST_WIDTH);
    if (!(max(width.x, width.y) < MOST_WIDTH)) return;
    float own = from.place.w / scale;
    vec2 reach = 0.5 * (width + own);
    if (any(lessThan(place + reach, vec2(first_pixel))) || any(greaterThan(place - reach, vec2(end_pixel)))) return;

    float share = light_weight(rays, ray.weight) / (float(from.cells) * float(from.cells) * stretch);
    bool is_iris_alone = false;  // no rim cuts its image
#ifdef SHAPED_IRIS
    is_iris_alone = true;
#ifdef POLYNOMIAL_LENS
    is_iris_alone = row[REGION + 3] <= 0.0;
#endif
    if (is_iris_alone) share *= openings[cell];
#endif
    if (!is_iris_alone) share *= open_share(rays, pupil_point(rays, disc), pupil_from_cell, 1.0, 1.0 / 3.0, false);
    if (!(share > 0.0)) return;
    share *= share_past(rays.centre, on_layers(rays, ray, vec2(0.0)), from.place.z);
    if (share > 0.0) splat(share * light * from.excess.rgb, place, width, own);
}
