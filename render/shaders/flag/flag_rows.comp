#version 450 core
// The horizontal pass of FLAG: what the pixels of a row shed on each column, piled up by how far above and below the row it reaches.
// in:  what each pixel sheds and how far (flag_shed.comp); the largest reach in each stretch of TILE pixels of a row
// out: `piles`: slice z holds what the row sheds on the pixel z above or below it in that column; in the other half of the slices
//      what it sheds below, where the shape is not symmetric. `heights`: the highest slice that holds anything
// Moersch & Hamilton 2014, section 3.2.2. Linear in the radius: a pixel looks along its row, then sums its pile from the top down.
// Slices above that height are not written.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform image2DArray piles;
layout(r32f, binding = 1) uniform writeonly image2D heights;

#include "layers/outline.glsl"

uniform sampler2D shed;
uniform sampler2D reach;
uniform sampler2D widest;       // of stretches of rows
uniform int first_row;          // of the picture's rows, of those that are new
uniform int rows;               // that are new
uniform int ring;               // rows that are held; a row stands where the one that many above it stood
uniform int most;               // slices of a half, less one

ivec2 own;                      // the column and the held row whose pile this is
int highest = -1;               // slice of a half that anything can end in

void add(int z, vec4 light)
{
    ivec3 at = ivec3(own, z);
    imageStore(piles, at, imageLoad(piles, at) + light);
}

// Let what reaches up by `side` end there, in the half of the slices from `first` on: the pixel that it ends in has its share of it.
void put(int first, vec4 light, float side)
{
    float t = side + 0.5;
    int k = int(t);
    vec2 shares = k == 0 ? vec2(0.0, 2.0 * side) : vec2(1.0 - (t - float(k)), t - float(k));
    add(first + clamp(k - 1, 0, highest), light * shares.x);
    add(first + min(k, highest), light * shares.y);
}

// Sum what ends at each height from the top down, and what falls on the row itself.
vec4 pile_up(int first)
{
    vec4 pile = vec4(0.0);
    for (int z = highest; z >= 0; --z) {
        ivec3 at = ivec3(own, first + z);
        pile += imageLoad(piles, at);
        imageStore(piles, at, pile);
    }
    return pile;
}

void gather(ivec2 at, int dx)
{
    ivec2 source = ivec2(at.x + dx, at.y);
    float radius = texelFetch(reach, source, 0).r;
    if (radius <= 0.0 || float(abs(dx)) >= radius && dx != 0) return;
    vec4 light = texelFetch(shed, source, 0);
    vec2 sides = reach_at(-dx, radius);
#ifdef TWO_SIDED
    put(0, light, sides.x);
    put(most + 1, light, sides.y);
#else
    put(0, light, 0.5 * (sides.x + sides.y));
#endif
}

// Whether a stretch of the row sheds anything on this column, and how far up at most.
bool reaches(ivec2 at, int tile, int from, int to, out float side)
{
    float nearest = float(max(max(from - at.x, at.x - to), 0));
    side = texelFetch(widest, ivec2(tile, at.y), 0).r;
    return side > 0.0 && (nearest == 0.0 || side > nearest);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    ivec2 size = textureSize(shed, 0);
    int row = int(gl_GlobalInvocationID.y);
    if (at.x >= size.x || row >= rows) return;
    own = ivec2(at.x, at.y % ring);
    if (at.y >= size.y) {
        imageStore(heights, own, vec4(-1.0));
        return;
    }
    int low = max(at.x - most, 0), high = min(at.x + most, size.x - 1);
    float side;
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        if (reaches(at, tile, max(tile * TILE, low), min(tile * TILE + TILE - 1, high), side)) highest = max(highest, int(side + 0.5));
    }
    highest = min(highest, most);
    imageStore(heights, own, vec4(float(highest)));
    if (highest < 0) return;
    for (int z = 0; z <= highest; ++z) {
        imageStore(piles, ivec3(own, z), vec4(0.0));
#ifdef TWO_SIDED
        imageStore(piles, ivec3(own, most + 1 + z), vec4(0.0));
#endif
    }
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        int from = max(tile * TILE, low), to = min(tile * TILE + TILE - 1, high);
        if (!reaches(at, tile, from, to, side)) continue;
        for (int x = from; x <= to; ++x) gather(at, x - at.x);
    }
    vec4 middle = pile_up(0);
#ifdef TWO_SIDED
    imageStore(piles, ivec3(own, 0), 0.5 * (middle + pile_up(most + 1)));   // half of it is above the middle, half below
#endif
}
