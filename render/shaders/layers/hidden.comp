#version 450 core
// The inverse depth from which layers/depth.frag discards every fragment of the next layer, for each tile of the picture.
// in:  w of a layer (1/m, negative where partly transparent, 0 where empty); with REACH the reach of lens rays (reach_spread.comp)
// out: the greatest limit of a tile's pixels, 1/m

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) writeonly buffer Limits { float limits[]; };

uniform sampler2D w;
uniform int channel;
uniform float umbra;  // least reach of an opaque surface's umbra in w, 1/m
uniform int columns;
#ifdef REACH
#include "trace/slopes.glsl"
uniform sampler2D reach;
const float FARTHEST = 0.999 - UNLIKE - 2.0 * LONGEST_REACH;    // least share of a fragment's w that depth.frag compares; rounding
#endif

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy), first = tile * TILE_PX, size = textureSize(w, 0);
    if (tile.x >= columns || first.y >= size.y) return;
    ivec2 end = min(first + TILE_PX, size);
    float limit = -umbra;
    for (int y = first.y; y < end.y; y++)
        for (int x = first.x; x < end.x; x++) {
            float here = texelFetch(w, ivec2(x, y), 0)[channel];
            float behind = abs(here) - (here > 0.0 ? umbra : 0.0);
#ifdef REACH
            behind = min(behind, max(texelFetch(reach, ivec2(x, y) / REACH_BLOCK, 0).x, 0.0) / FARTHEST);
#endif
            limit = max(limit, behind);
        }
    limits[tile.y * columns + tile.x] = limit;
}
