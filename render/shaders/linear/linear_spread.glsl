// Sheds light on a column of ROWS pixels, exactly: weights are multiples of 2^-20 and light of 2^-29 of the picture's scale, so that
// every sum of their products is a whole number of 2^-49 that 53 bits hold, whatever the order it is made in (linear.py).

uniform sampler2DArray weights;     // spread_tables.py: slices are tables, texels hold the weights of four rows
uniform int half_px;                // from the middle of a table to its edge, where there is no weight: what is out of reach is clamped to it
uniform float own_share;            // and by more than so many times the radius of what is not
uniform float cutoff_px;            // what is farther, and blurred by more than this, is hidden by what is sharp

dvec4 total[ROWS];                  // what the pixels of this column have got
float own_px[ROWS];                 // their radii: in front of the focus above 0, behind it below
#ifdef REJUDGE
float before_px[ROWS];              // those by which they were judged
#endif

// Whether light of a radius is hidden by what lies where it falls. What is blurred itself hides only part of what is around it.
bool is_hidden(float from_px, float here_px)
{
    return from_px < own_share * min(here_px, 0.0) - cutoff_px;
}

// Factor of light of a radius on a pixel of this column.
float counted(float from_px, int row)
{
    float counts = is_hidden(from_px, own_px[row]) ? 0.0 : 1.0;
#ifdef REJUDGE
    counts -= is_hidden(from_px, before_px[row]) ? 0.0 : 1.0;
#endif
    return counts;
}

// light: premultiplied; table: its number; from_px: its radius; offset: of the column's first pixel from where it comes from
void shed(dvec4 light, int table, float from_px, ivec2 offset)
{
    int column = clamp(offset.x, -half_px, half_px) + half_px;
    for (int first = 0; first < ROWS; first += 4) {
        int row = clamp(offset.y + first, -half_px - 3, half_px) + half_px + 3;
        vec4 here = texelFetch(weights, ivec3(column, row, table), 0);
        for (int i = 0; i < min(4, ROWS); ++i) total[first + i] += double(here[i] * counted(from_px, first + i)) * light;
    }
}
