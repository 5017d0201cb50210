#version 450 core
// The vertical pass of FLAG: each pixel gathers, from the rows above and below, what they shed as far as this.
// in:  piles and heights of the rows that are held (flag_rows.comp), and the largest heights in stretches of TILE rows
// out: `blurred`: the field's light, and how much of it there is, in the rows whose neighbours are all held
// Moersch & Hamilton 2014, section 3.2.3.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform writeonly image2D blurred;

uniform sampler2DArray piles;
uniform sampler2D heights;
uniform sampler2D tallest;
uniform int first_row;          // of those
uniform int rows;
uniform int ring;               // rows that are held, whole stretches
uniform int most;

// Light of the row stored in `held`, which lies `below` rows below this one, on this row.
vec4 shed_by(int x, int held, int below)
{
    int z = abs(below);
    if (float(z) > texelFetch(heights, ivec2(x, held), 0).r) return vec4(0.0);
#ifdef TWO_SIDED
    if (below < 0) z += most + 1;       // of a row above, what it sheds below itself
#endif
    return texelFetch(piles, ivec3(x, held, z), 0);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row), size = imageSize(blurred);
    if (int(gl_GlobalInvocationID.y) >= rows || any(greaterThanEqual(at, size))) return;
    int low = max(at.y - most, 0), high = min(at.y + most, size.y - 1);
    vec4 total = vec4(0.0);
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        int from = max(tile * TILE, low), to = min(tile * TILE + TILE - 1, high);
        int held = tile % (ring / TILE);
        float nearest = float(max(max(from - at.y, at.y - to), 0));
        if (texelFetch(tallest, ivec2(at.x, held), 0).r < nearest) continue;
        for (int row = from; row <= to; ++row) total += shed_by(at.x, row + (held - tile) * TILE, row - at.y);
    }
    imageStore(blurred, at, total);
}
