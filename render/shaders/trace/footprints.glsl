// Contents of peeled layers under a footprint: the range of inverse depth, and the intervals of it that hold surfaces.
// Lee, Eisemann & Seidel 2010, section 3.1, "Computing Min/Max Values".
// Positions count in pixels of the whole picture's layers. The textures may hold a part of them, from `layer_first` on.

uniform sampler2DArray ranges;  // N-buffers
uniform usampler2DArray bins;
uniform int last_level;         // last level of the N-buffers
uniform vec2 w_range;           // range of w of all bins; every surface is within it

uniform ivec2 layer_first;      // first pixel of the textures, a multiple of a block
uniform ivec2 layer_last;       // last pixel of the layers, counted from `layer_first`

#include "layers/bins.glsl"

const int BLOCK = 4;
const int MAX_INTERVALS = 8;         // intervals of w with surfaces that a pixel's rays search; further ones are merged

struct Corners { ivec2 a; ivec2 c; int level; };

// Four overlapping squares of an N-buffer that cover the layer pixels from `low` to `high`.
Corners corners_over(ivec2 low, ivec2 high)
{
    ivec2 first = layer_first / BLOCK, last = layer_last / BLOCK;
    ivec2 a = clamp(low / BLOCK - first, ivec2(0), last), b = clamp(high / BLOCK - first, ivec2(0), last);
    ivec2 extent = b - a + 1;
    int level = min(findMSB(max(max(extent.x, extent.y), 1)), last_level);
    return Corners(a, max(b - (1 << level) + 1, a), level);
}

// Square around the box from `low` to `high` that lies no farther from `centre` than the box: `corners_over` reads squares, which would go
// beyond a long box, and with that beyond the layers that the pixel at `centre` is traced through.
vec4 square_toward(vec2 centre, vec2 low, vec2 high)
{
    vec2 size = high - low, far = max(abs(low - centre), abs(high - centre));
    float side = max(size.x, size.y);
    low = min(low, centre + max(far.x, far.y) - side);
    return vec4(low, low + side);
}

// Range of w over the layer pixels from `low` to `high`.
vec2 range_over(ivec2 low, ivec2 high)
{
    Corners s = corners_over(low, high);
    vec2 r0 = texelFetch(ranges, ivec3(s.a, s.level), 0).xy;
    vec2 r1 = texelFetch(ranges, ivec3(s.c.x, s.a.y, s.level), 0).xy;
    vec2 r2 = texelFetch(ranges, ivec3(s.a.x, s.c.y, s.level), 0).xy;
    vec2 r3 = texelFetch(ranges, ivec3(s.c, s.level), 0).xy;
    return vec2(min(min(r0.x, r1.x), min(r2.x, r3.x)), max(max(r0.y, r1.y), max(r2.y, r3.y)));
}

// Bins of w that hold a surface of those pixels.
uvec2 bins_over(ivec2 low, ivec2 high)
{
    Corners s = corners_over(low, high);
    return texelFetch(bins, ivec3(s.a, s.level), 0).xy | texelFetch(bins, ivec3(s.c.x, s.a.y, s.level), 0).xy
         | texelFetch(bins, ivec3(s.a.x, s.c.y, s.level), 0).xy | texelFetch(bins, ivec3(s.c, s.level), 0).xy;
}

// Intervals of w, near to far, that a pixel's rays search.
vec2 intervals[MAX_INTERVALS];
int interval_count;

// Intervals of consecutive occupied bins within `range`.
void find_intervals(uvec2 occupied, vec2 range)
{
    float width = (w_range.y - w_range.x) / float(BINS);
    interval_count = 0;
    int above = BINS;  // bins from here on are done
    while (true) {
        uvec2 left = above > 0 ? occupied & bits_between(0, above - 1) : uvec2(0u);
        int top = left.y != 0u ? 32 + findMSB(left.y) : findMSB(left.x);
        if (top < 0) break;
        uvec2 empty = top > 0 ? ~occupied & bits_between(0, top - 1) : uvec2(0u);
        above = 1 + (empty.y != 0u ? 32 + findMSB(empty.y) : findMSB(empty.x));
        vec2 interval = vec2(max(w_range.x + float(above) * width, range.x), min(w_range.x + float(top + 1) * width, range.y));
        if (interval_count < MAX_INTERVALS) intervals[interval_count++] = interval;
        else intervals[MAX_INTERVALS - 1].x = interval.x;
    }
}
