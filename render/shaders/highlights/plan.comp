#version 450 core
// Plan how each highlight is carried: its excess over its surroundings, and the box of pixels that its blurred image covers.
// in:  texels (x | y << 16, layer); layers (march.glsl), means, lens
// out: plans; the box is empty where the highlight is better left to the rays
// A box is that of the images of points of the pupil's rim, found by the iteration p ← p + (q - s(p)) / scale. It holds all of the
// blurred image where that does not fold: the pupil's image on the layers has the same orientation everywhere. Where that folds, or is
// uneven, the highlight is scattered, and its plan says into how many cells the pupil is divided (scatter.comp).

layout(local_size_x = 64) in;

#include "trace/march.glsl"
#include "highlights/surroundings.glsl"
#include "highlights/connection.glsl"
#include "highlights/texel.glsl"

struct Plan {
    vec4 excess;        // radiance times opacity times area (layer pixels²); w seen from the picture's camera (1/m)
    vec4 box;           // first and last place, picture pixels
    float front;        // inverse depth on the layers from which on surfaces are in the way, 1/m
    uint cells;         // of the pupil across and down, + UNEVEN where the blurred image is uneven
    uvec2 base;         // what rays are to see, four halves; opacity is the texel's own
    uvec2 exact;        // what the texel holds
    vec2 place;         // of its centre in the picture's frame, layer pixels
    float area;         // of the texel's image there, layer pixels²
};
layout(std430, binding = 0) readonly buffer Texels { uvec2 texels[]; };
layout(std430, binding = 1) buffer Plans { Plan plans[]; };

uniform int count;
uniform bool is_first;          // first wavelength: others widen its box
uniform float blur_px;
uniform float least_radius;     // layer pixels
#ifdef GRID_LENS
uniform vec3 grid_changes;      // bounds of the table's changes over the unit disc (render.trace.highlights.evenness)
#endif

const int SPOKES = 12;
const float WIDEN = 1.04;       // of a polygon of SPOKES corners to the circle around it
const int ROUNDS = 5;
const float MOST_MISS = 0.5;    // picture pixels
const float CLOSE = 0.1;        // picture pixels; a smaller miss ends the search, and boxes are wider by 2 pixels
const int RINGS = 4;            // within the pupil
const float ROOM = 0.05;        // of clearance
const float LEAST_EVENNESS = 0.2;   // least area of the pupil's image over its largest, of large images
const float EVEN_RADIUS = 12.0;     // layer pixels; connections take a small image for even within a pixel

const uint UNEVEN = 0x10000u;
const float CELL_PX = 0.75;     // size of a cell's image in the mean, picture pixels
const float RIM_CELL_PX = 2.0;  // at the rim, where images of cells are longest
const float LEAST_CELLS = 6.0, MOST_CELLS = 128.0;
const float INNER_RING = 0.6;

// Blurred image of a highlight: box in picture pixels, empty where the highlight is left to the rays; cells as in its plan.
struct Blurred { vec4 box; uint cells; };
const Blurred LEFT = Blurred(vec4(0.0), 0u);

// Whether a rim blocks a point of the pupil clearly; not of a grid.
bool is_blocked(PixelRays rays, vec2 l)
{
#ifdef POLYNOMIAL_LENS
    vec2 stop = vec2(row[REGION], 0.0) + vec2(row[REGION + 1], row[REGION + 2]) * l;
    float blocked = max(max(even4(FRONT_RIM, l.x, l.y * l.y), even4(REAR_RIM, l.x, l.y * l.y)), dot(stop, stop) - 1.0);
    return row[REGION + 3] > 0.0 && blocked > ROOM;
#else
    return false;
#endif
}

// Note the area that the pupil has in the picture's frame near an open point of it, relative to the pupil's.
void note_area(PixelRays rays, vec2 l, float w, inout vec2 areas)
{
    if (is_blocked(rays, l)) return;
    float area = determinant(land(rays, l, w).by_pupil);
    areas = vec2(min(areas.x, area), max(areas.y, area));
}

// Least share of areas of an image of some radius, layer pixels.
float least_evenness(float radius)
{
    return max(LEAST_EVENNESS, 1.0 - radius / EVEN_RADIUS);
}

// Whether areas of the pupil's image have the same orientation, and about the same size.
bool are_even(vec2 areas, float least)
{
    vec2 size = abs(areas);
    return areas.x * areas.y > 0.0 && min(size.x, size.y) >= least * max(size.x, size.y);
}

// Whether the open pupil's image at inverse depth w is even within the rim. `areas`: the least and the largest.
bool is_even_within(PixelRays rays, float w, inout vec2 areas)
{
#ifdef POLYNOMIAL_LENS
    bool is_even = true;
    for (int k = RINGS * SPOKES - 1; k >= 0 && is_even; --k) {  // from the outermost ring, which is uneven most often
        float angle = 6.283185307 * (float(k) + 0.5) / float(SPOKES), radius = sqrt(float(k / SPOKES) / float(RINGS));
        note_area(rays, radius * vec2(cos(angle), sin(angle)), w, areas);
        is_even = areas.x > areas.y || are_even(areas, LEAST_EVENNESS);
    }
    return is_even;
#elif defined(GRID_LENS)
    // derivatives of the landing are off_focus·(c + e) + s with |s| <= x, |e| <= y and c = z
    float off_focus = abs(rays.pupil * (w - rays.w_f)), apart = grid_changes.x + off_focus * grid_changes.y, mean_size = off_focus * grid_changes.z;
    return (mean_size - apart) > sqrt(least_evenness(mean_size * focal_px.y)) * (mean_size + apart);
#else
    return true;
#endif
}

// Widen the box of a blurred image that may fold by the images of two rings of the pupil, as the pixel in the box's middle has them, and
// find how long the pupil's image is along and across, layer pixels: at most, in units of the pupil's radius.
float measure_rings(vec2 q, float w, vec2 middle, inout vec2 low, inout vec2 high)
{
    PixelRays rays = rays_from(middle);
    float longest = 0.0;
    for (int k = 0; k < 2 * SPOKES; ++k) {
        float angle = 6.283185307 * float(k) / float(SPOKES), radius = k < SPOKES ? RIM : INNER_RING;
        vec2 l = radius * vec2(cos(angle), sin(angle));
        if (is_blocked(rays, l)) continue;
        Landing landing = land(rays, l, w);
        if (landing.from.weight <= 0.0) continue;
        vec2 place = middle + (q - rays.centre - landing.place) / scale;
        low = min(low, place);
        high = max(high, place);
        longest = max(longest, max(length(landing.by_pupil[0]), length(landing.by_pupil[1])));
    }
    return longest;
}

// Blurred image of a texel at place q of the picture's frame, layer pixels.
Blurred blurred_image(vec2 q, float w)
{
    vec2 middle = (q - offset) / scale, low = vec2(1e9), high = vec2(-1e9), areas = vec2(1e30, -1e30);
    bool is_even = true;
    for (int k = -1; k < SPOKES; ++k) {  // the pupil's centre, then its rim
        float angle = 6.283185307 * (float(k) + 0.5) / float(SPOKES);
        vec2 place = k < 0 ? vec2(0.0) : vec2(cos(angle), sin(angle)), p = middle, miss = vec2(1e9), l = place;
        PixelRays rays;  // of p; the first round sets them
        for (int round = 0; round < ROUNDS; ++round) {
            if (all(lessThan(abs(miss), vec2(CLOSE)))) break;
            rays = rays_from(p);
#ifdef POLYNOMIAL_LENS
            l = in_plane(rays, place);
#endif
            LensRay ray = on_picture(rays, table_ray(rays, l), vec2(0.0));
            if (ray.weight <= 0.0) return LEFT;  // of a grid
            miss = (q - met_at(ray, w)) / scale;
            p += miss;
        }
#ifdef POLYNOMIAL_LENS
        if (k >= 0) note_area(rays, l, w, areas);
#endif
        if (!(max(abs(miss.x), abs(miss.y)) < MOST_MISS)) return LEFT;
        if (k < 0) {
            middle = p;
            is_even = is_even_within(rays_from(middle), w, areas);
            continue;
        }
        low = min(low, p);
        high = max(high, p);
    }
    vec2 half_size = 0.5 * (high - low);
#ifdef POLYNOMIAL_LENS
    is_even = is_even && are_even(areas, least_evenness(scale * min(half_size.x, half_size.y)));
#endif
    uint cells = 0u;
#if defined(POLYNOMIAL_LENS) || defined(GRID_LENS)
    float across = max(half_size.x, half_size.y) * 2.0 / CELL_PX;
    if (!is_even) {
        float longest = measure_rings(q, w, middle, low, high);
        half_size = 0.5 * (high - low);
        across = max(max(half_size.x, half_size.y) * 2.0 / CELL_PX, 2.0 * longest / (scale * RIM_CELL_PX));
        if (across > MOST_CELLS) return LEFT;
    }
    cells = uint(clamp(ceil(across), LEAST_CELLS, MOST_CELLS)) | (is_even ? 0u : UNEVEN);
#endif
    if (min(half_size.x, half_size.y) * scale < least_radius) return LEFT;
    middle = 0.5 * (low + high);
    half_size = half_size * WIDEN + 2.0;
    return Blurred(vec4(middle - half_size, middle + half_size), cells);
}

void main()
{
    int i = int(gl_GlobalInvocationID.x);
    if (i >= count) return;
    ivec2 texel = ivec2(texels[i].x & 0xffffu, texels[i].x >> 16);
    int layer = int(texels[i].y);
    float stored = stored_w(texel, layer);
    Seen seen = seen_texel(texel, layer, abs(stored));
    float w = seen.w;
    vec4 surface = texelFetch(radiance, ivec3(texel, layer), 0);
    vec2 q = seen.place, focused = focus_at((q - offset) / scale);

    float share = min(1.0, luminance_around(texel, blur_px * focused.y * abs(w - focused.x)) / luminance_of(surface, stored));
    uvec2 base = uvec2(packHalf2x16(share * surface.rg), packHalf2x16(vec2(share * surface.b, surface.a)));
    vec3 held = vec3(unpackHalf2x16(base.x), unpackHalf2x16(base.y).x);
    vec3 excess = (surface.rgb - held) * (stored > 0.0 ? 1.0 : surface.a) * seen.area;
    float front = seen.w_on_layers;
    front += UNLIKE * front + 2.0 * reach_at(texel, layer) * front;

    Blurred image = w > 0.0 && (is_first || plans[i].box.z > plans[i].box.x) ? blurred_image(q, w) : LEFT;
    vec4 box = image.box;
    uint cells = image.cells;
    if (!is_first) {
        bool both = plans[i].box.z > plans[i].box.x && box.z > box.x;
        box = both ? vec4(min(box.xy, plans[i].box.xy), max(box.zw, plans[i].box.zw)) : vec4(0.0);
        cells = max(cells & ~UNEVEN, plans[i].cells & ~UNEVEN) | ((cells | plans[i].cells) & UNEVEN);
    }
    plans[i] = Plan(vec4(excess, w), box, front, cells, base, uvec2(packHalf2x16(surface.rg), packHalf2x16(surface.ba)),
                    q, seen.area);
}
