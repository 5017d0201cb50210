#version 450 core
// Horizontal pass of FLAG: contributions of a row to each column, accumulated over the distance above and below the row.
// in:  intensity and radius of each pixel (point_spread.comp); the greatest radius in each tile of TILE pixels of a row
// out: `contributions`: slice z is the row's contribution to the pixel z above or below it in that column; where the shape is not
//      symmetric, the second half of the slices is for pixels below. `heights`: the highest slice that is written
// Moersch & Hamilton 2014, section 3.2.2. Linear in the radius: a pixel gathers along its row, then accumulates from the top down.
// Slices above that height are not written.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform image2DArray contributions;
layout(r32f, binding = 1) uniform writeonly image2D heights;

#include "layers/outline.glsl"

const float ROUNDING = 1e-6;    // share of all added light below which a sum is none

uniform sampler2D intensity;
uniform sampler2D radii;
uniform sampler2D tile_radius;  // greatest radius in each tile of a row
uniform int first_row;          // first new row of the picture
uniform int rows;               // number of new rows
uniform int ring;               // stored rows; a row takes the place of the one that many above it
uniform int most;               // slices of a half, less one
uniform int across;             // greatest distance along a row

ivec2 own;                      // column and stored row of this invocation
int highest = -1;               // highest slice of a half that a column can end in

void add(int z, vec4 light)
{
    ivec3 at = ivec3(own, z);
    imageStore(contributions, at, imageLoad(contributions, at) + light);
}

// Add light that ends at height `extent`, in the half of the slices from `first` on; the last pixel gets its share.
void put(int first, vec4 light, float extent)
{
    float t = extent + 0.5;
    int k = int(t);
    vec2 shares = k == 0 ? vec2(0.0, 2.0 * extent) : vec2(1.0 - (t - float(k)), t - float(k));
    add(first + clamp(k - 1, 0, highest), light * shares.x);
    add(first + min(k, highest), light * shares.y);
}

#ifdef TWO_SIDED
// Add light between two heights of a half. Nothing is added where the half is empty.
void put_between(int first, vec4 light, float from, float to)
{
    if (to <= 0.0) return;
    put(first, light, to);
    if (from > 0.0) put(first, -light, from);
}
#endif

// Accumulate the slices from the top down, and return the contribution to the row itself. A remainder of light that begins and
// ends is no light.
vec4 accumulate(int first)
{
    vec4 total = vec4(0.0);
#ifdef TWO_SIDED
    float passed = 0.0;
#endif
    for (int z = highest; z >= 0; --z) {
        ivec3 at = ivec3(own, first + z);
        vec4 more = imageLoad(contributions, at);
        total += more;
#ifdef TWO_SIDED
        passed += abs(more.a);
        if (total.a < ROUNDING * passed) total = vec4(0.0);
#endif
        imageStore(contributions, at, total);
    }
    return total;
}

void gather(ivec2 at, int dx)
{
    ivec2 source = ivec2(at.x + dx, at.y);
    float radius = texelFetch(radii, source, 0).r;
    if (radius <= 0.0 || !has_column(-dx, radius)) return;
    vec4 light = texelFetch(intensity, source, 0);
    vec2 extents = reach_at(float(-dx), radius);
#ifdef TWO_SIDED
    put_between(0, light, -extents.y, extents.x);
    put_between(most + 1, light, -extents.x, extents.y);
#else
    put(0, light, 0.5 * (extents.x + extents.y));
#endif
}

// True where a tile of the row reaches this column; `extent` is its greatest radius.
bool reaches(ivec2 at, int tile, int from, int to, out float extent)
{
    float nearest = float(max(max(from - at.x, at.x - to), 0));
    extent = texelFetch(tile_radius, ivec2(tile, at.y), 0).r;
    return extent > 0.0 && (nearest == 0.0 || extent * max(-span.x, span.y) > nearest);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    ivec2 size = textureSize(intensity, 0);
    int row = int(gl_GlobalInvocationID.y);
    if (at.x >= size.x || row >= rows) return;
    own = ivec2(at.x, at.y % ring);
    if (at.y >= size.y) {
        imageStore(heights, own, vec4(-1.0));
        return;
    }
    int low = max(at.x - across, 0), high = min(at.x + across, size.x - 1);
    float extent;
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        if (reaches(at, tile, max(tile * TILE, low), min(tile * TILE + TILE - 1, high), extent)) highest = max(highest, int(extent + 0.5));
    }
    highest = min(highest, most);
    imageStore(heights, own, vec4(float(highest)));
    if (highest < 0) return;
    for (int z = 0; z <= highest; ++z) {
        imageStore(contributions, ivec3(own, z), vec4(0.0));
#ifdef TWO_SIDED
        imageStore(contributions, ivec3(own, most + 1 + z), vec4(0.0));
#endif
    }
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        int from = max(tile * TILE, low), to = min(tile * TILE + TILE - 1, high);
        if (!reaches(at, tile, from, to, extent)) continue;
        for (int x = from; x <= to; ++x) gather(at, x - at.x);
    }
    vec4 middle = accumulate(0);
#ifdef TWO_SIDED
    // half of the row lies above its middle, half below
    imageStore(contributions, ivec3(own, 0), 0.5 * (middle + accumulate(most + 1)));
#endif
}
