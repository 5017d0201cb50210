#version 450 core
// The vertical pass of FLAG: each pixel gathers, from the rows above and below, what they shed as far as this.
// in:  piles and heights of a band of rows (flag_rows.comp)
// out: `blurred`: the field's light, and how much of it there is, in the rows that the band is for
// Moersch & Hamilton 2014, section 3.2.3.

layout(local_size_x = 32, local_size_y = 2) in;
layout(rgba32f, binding = 0) uniform writeonly image2D blurred;

uniform sampler2DArray piles;
uniform sampler2D heights;
uniform int first_row;          // of the picture's rows, of this band
uniform int rows;               // of the band
uniform int first_wanted;       // of the picture's rows
uniform int wanted;
uniform int most;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_wanted);
    if (at.x >= imageSize(blurred).x || int(gl_GlobalInvocationID.y) >= wanted || at.y >= imageSize(blurred).y) return;
    int own = at.y - first_row;
    vec4 total = vec4(0.0);
    for (int row = max(own - most, 0); row <= min(own + most, rows - 1); ++row) {
        int z = abs(row - own);
        if (float(z) > texelFetch(heights, ivec2(at.x, row), 0).r) continue;
#ifdef TWO_SIDED
        // of a row below, what it sheds above itself; the row itself has half of it on either side
        if (row >= own) total += texelFetch(piles, ivec3(at.x, row, z), 0) * (row == own ? 0.5 : 1.0);
        if (row <= own) total += texelFetch(piles, ivec3(at.x, row, most + 1 + z), 0) * (row == own ? 0.5 : 1.0);
#else
        total += texelFetch(piles, ivec3(at.x, row, z), 0);
#endif
    }
    imageStore(blurred, at, total);
}
