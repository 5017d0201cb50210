#version 450 core
// The inverse depth from which layers/depth.frag discards every fragment of the next layer, for each tile of the picture.
// in:  w of a layer (1/m, negative where partly transparent, 0 where empty)
// out: the greatest limit of a tile's pixels, 1/m

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) writeonly buffer Limits { float limits[]; };

uniform sampler2D w;
uniform int channel;
uniform float umbra;  // least reach of an opaque surface's umbra in w, 1/m
uniform int columns;

void main()
{
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy), first = tile * TILE_PX, size = textureSize(w, 0);
    if (tile.x >= columns || first.y >= size.y) return;
    ivec2 end = min(first + TILE_PX, size);
    float limit = -umbra;
    for (int y = first.y; y < end.y; y++)
        for (int x = first.x; x < end.x; x++) {
            float here = texelFetch(w, ivec2(x, y), 0)[channel];
            limit = max(limit, abs(here) - (here > 0.0 ? umbra : 0.0));
        }
    limits[tile.y * columns + tile.x] = limit;
}
