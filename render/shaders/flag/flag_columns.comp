#version 450 core
// Vertical pass of FLAG: each pixel gathers the contributions of the rows above and below that reach it.
// in:  contributions and heights of the stored rows (flag_rows.comp), and the greatest height in each tile of TILE rows
// out: `blurred`: light and coverage of the field, in the rows whose neighbours are all stored
// Moersch & Hamilton 2014, section 3.2.3.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform writeonly image2D blurred;

uniform sampler2DArray contributions;
uniform sampler2D heights;
uniform sampler2D tile_height;
uniform int first_row;          // first finished row
uniform int rows;
uniform int ring;               // stored rows, whole tiles
uniform int most;

// Contribution to this row of the row stored in `slot`, which lies `below` rows below.
vec4 contribution_of(int x, int slot, int below)
{
    int z = abs(below);
    if (float(z) > texelFetch(heights, ivec2(x, slot), 0).r) return vec4(0.0);
#ifdef TWO_SIDED
    if (below < 0) z += most + 1;       // a row above contributes by its lower half
#endif
    return texelFetch(contributions, ivec3(x, slot, z), 0);
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row), size = imageSize(blurred);
    if (int(gl_GlobalInvocationID.y) >= rows || any(greaterThanEqual(at, size))) return;
    int low = max(at.y - most, 0), high = min(at.y + most, size.y - 1);
    vec4 total = vec4(0.0);
    for (int tile = low / TILE; tile <= high / TILE; ++tile) {
        int from = max(tile * TILE, low), to = min(tile * TILE + TILE - 1, high);
        int slot = tile % (ring / TILE);
        float nearest = float(max(max(from - at.y, at.y - to), 0));
        if (texelFetch(tile_height, ivec2(at.x, slot), 0).r < nearest) continue;
        for (int row = from; row <= to; ++row) total += contribution_of(at.x, row + (slot - tile) * TILE, row - at.y);
    }
    imageStore(blurred, at, total);
}
