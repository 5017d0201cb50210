#version 450 core
// The horizontal pass of FLAG: what the pixels of a row shed on each column, piled up by how far above and below the row it reaches.
// in:  light of a field (premultiplied), its radii in pixels, the outline of the blur and the light of a spread point (blur_shape.py);
//      the largest radius in each stretch of TILE pixels of a row
// out: `piles`: slice z holds what the row sheds on the pixel z above or below it in that column; in the other half of the slices
//      what it sheds below, where the shape is not symmetric. `heights`: the highest slice that holds anything
// Moersch & Hamilton 2014, section 3.2.2. Linear in the radius: a pixel looks along its row, then sums its pile from the top down.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform image2DArray piles;
layout(r32f, binding = 1) uniform writeonly image2D heights;

#include "flag_split.glsl"

uniform sampler2D light;
uniform sampler2D radii;
uniform sampler2D widest;       // of stretches of rows
uniform sampler2D outline;      // reach up and down over columns from -1 to 1
uniform sampler2D area;         // over radii of 1 / AREA_STEPS pixels
uniform int channel;            // of the radii
uniform int first_row;          // of the picture's rows, of this band
uniform int rows;
uniform int most;               // slices of a half, less one

ivec2 own;                      // the column and row of the band whose pile this is

void add(int z, vec4 shed)
{
    ivec3 at = ivec3(own, z);
    imageStore(piles, at, imageLoad(piles, at) + shed);
}

// Let what reaches up by `reach` end there, in the half of the slices from `first` on: the pixel that it ends in has its share of it.
void put(int first, vec4 shed, float reach)
{
    float t = reach + 0.5;
    int k = int(t);
    if (k == 0) {
        add(first, shed * min(2.0 * reach, 1.0));
        return;
    }
    float share = t - float(k);
    add(first + min(k - 1, most), shed * (1.0 - share));
    add(first + min(k, most), shed * share);
}

// Sum what ends at each height from the top down; the highest that holds anything, -1 for none.
int pile_up(int first)
{
    vec4 pile = vec4(0.0);
    int highest = -1;
    for (int z = most; z >= 0; --z) {
        ivec3 at = ivec3(own, first + z);
        pile += imageLoad(piles, at);
        if (highest < 0 && pile.a > 0.0) highest = z;
        imageStore(piles, at, pile);
    }
    return highest;
}

void gather(ivec2 at, int dx)
{
    ivec2 source = ivec2(at.x + dx, at.y);
    float radius = texelFetch(radii, source, 0)[channel];
    if (radius <= 0.0 || float(abs(dx)) >= radius && dx != 0) return;
    vec4 from = texelFetch(light, source, 0) * (1.0 - wide_share(radius));
    if (from.a == 0.0) return;
    radius = max(radius, LEAST);
    vec2 reach = radius * textureLod(outline, vec2((0.5 - 0.5 * float(dx) / radius) * OUTLINE_INSET + OUTLINE_EDGE, 0.5), 0.0).xy;
    vec4 shed = from / textureLod(area, vec2((radius * AREA_STEPS + 0.5) / float(textureSize(area, 0).x), 0.5), 0.0).r;
#ifdef TWO_SIDED
    put(0, shed, reach.x);
    put(most + 1, shed, reach.y);
#else
    put(0, shed, 0.5 * (reach.x + reach.y));
#endif
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row);
    ivec2 size = textureSize(light, 0);
    int row = int(gl_GlobalInvocationID.y);
    if (at.x >= size.x || row >= rows || at.y >= size.y) return;
    own = ivec2(at.x, row);
#ifdef TWO_SIDED
    int slices = 2 * most + 2;
#else
    int slices = most + 1;
#endif
    for (int z = 0; z < slices; ++z) imageStore(piles, ivec3(own, z), vec4(0.0));
    int low = max(at.x - most, 0), high = min(at.x + most, size.x - 1);
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        int from = max(tile * TILE, low), to = min(tile * TILE + TILE - 1, high);
        float nearest = float(max(max(from - at.x, at.x - to), 0));
        float most_here = texelFetch(widest, ivec2(tile, at.y), 0)[channel];
        if (split_px > 0.0) most_here = min(most_here, split_px);
        if (most_here <= 0.0 || nearest > 0.0 && most_here <= nearest) continue;
        for (int x = from; x <= to; ++x) gather(at, x - at.x);
    }
    int highest = pile_up(0);
#ifdef TWO_SIDED
    highest = max(highest, pile_up(most + 1));
#endif
    imageStore(heights, own, vec4(float(highest)));
}
