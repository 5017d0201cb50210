// Exact spreading of light onto a column of ROWS pixels: weights are multiples of 2^-20 and light of 2^-29 of the picture's scale
// (2^-25 through a mask), so that every sum of products is a multiple that 53 bits hold, in any order of summation (linear.py).

uniform sampler2DArray weights;     // spread_tables.py: slices are tables, texels hold the weights of four rows
uniform int half_px;                // pixels from the middle of a table to its edge, where the weight is 0; offsets beyond are clamped to it
uniform float own_share;            // a nearer pixel hides a farther one that is blurred by more than this many times its own radius
uniform float cutoff_px;            // a sharp pixel hides a farther one that is blurred by more than this

dvec4 total[ROWS];                  // sums of this column's pixels
float own_px[ROWS];                 // their signed radii: positive in front of the focus
#ifdef RECHECK
float before_px[ROWS];              // signed radii at the last check
#endif

// Whether a pixel with radius here_px hides light of radius from_px. A blurred pixel hides only part of its surroundings.
bool is_hidden(float from_px, float here_px)
{
    return from_px < own_share * min(here_px, 0.0) - cutoff_px;
}

// Factor of light of a radius on a pixel of this column.
float visibility(float from_px, int row)
{
    float factor = is_hidden(from_px, own_px[row]) ? 0.0 : 1.0;
#ifdef RECHECK
    factor -= is_hidden(from_px, before_px[row]) ? 0.0 : 1.0;
#endif
    return factor;
}

// light: premultiplied; table: number of its table; from_px: its signed radius; offset: from its pixel to the column's first one
void spread_light(dvec4 light, int table, float from_px, ivec2 offset)
{
    int column = clamp(offset.x, -half_px, half_px) + half_px;
    for (int first = 0; first < ROWS; first += 4) {
        int row = clamp(offset.y + first, -half_px - 3, half_px) + half_px + 3;
        vec4 here = texelFetch(weights, ivec3(column, row, table), 0);
        for (int i = 0; i < min(4, ROWS); ++i) total[first + i] += double(here[i] * visibility(from_px, first + i)) * light;
    }
}
