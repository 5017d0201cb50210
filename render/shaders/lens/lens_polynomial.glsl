// Row of the lens table for a pixel: polynomials over the pupil, in the plane of the pixel and the axis.
// in:  rows of ROW_VEC4 texels each in `lens_rows`, one for each field height, evenly from the axis to `last_slope`
// x is the tangential pupil coordinate (toward the pixel), y the sagittal one, both on the unit disc that bounds the open pupil
// (the layout of a row is in render/trace/lens_fit.py)

uniform sampler2D lens_rows;

uniform int first_row;          // first row of this wavelength
uniform int row_count;
uniform float last_slope;       // field of the last row, slope in object space

float row[4 * ROW_VEC4];

// Load four numbers of the row between two neighbours.
void load_four(int i, int first, float part)
{
    if (i >= ROW_VEC4) return;
    int texel = min(i, ROW_VEC4 - 1);  // NVIDIA's compiler judges constant indices after a return too
    vec4 v = mix(texelFetch(lens_rows, ivec2(texel, first), 0), texelFetch(lens_rows, ivec2(texel, first + 1), 0), part);
    row[4 * texel] = v.x;
    row[4 * texel + 1] = v.y;
    row[4 * texel + 2] = v.z;
    row[4 * texel + 3] = v.w;
}

#define LOAD_FOUR(i) load_four(i, first, part); load_four((i) + 1, first, part); load_four((i) + 2, first, part); load_four((i) + 3, first, part);

// Written out, without a loop: where an index varies, Mesa's CPU rasteriser reads and writes an array number by number.
void load_row(float slope)
{
    float at = min(slope / last_slope, 1.0) * float(row_count - 1);
    int index = min(int(at), row_count - 2), first = first_row + index;
    float part = at - float(index);
    LOAD_FOUR(0) LOAD_FOUR(4) LOAD_FOUR(8) LOAD_FOUR(12) LOAD_FOUR(16)
    LOAD_FOUR(20) LOAD_FOUR(24) LOAD_FOUR(28) LOAD_FOUR(32) LOAD_FOUR(36)  // a row of degree 13 has 40
}

float horner(int first, int degree, float x)
{
    float value = row[first + degree];
    for (int i = degree - 1; i >= 0; --i) value = value * x + row[first + i];
    return value;
}

// Polynomials that are even in y; those odd in y are y times an even one of a degree less. A row has room for the highest degree
// (5 for pupil points; for slopes 7, and more at the row's end); where a lower degree suffices, the terms above it are left out.
float even2(int i, float x, float y2) { return horner(i, 2, x) + y2 * row[i + 3]; }
float even4(int i, float x, float y2) { return horner(i, 4, x) + y2 * (horner(i + 5, 2, x) + y2 * row[i + 8]); }

#if SLOPE_DEGREE > 7
// Add the terms with the power `j` of y, which has the value `power`. Their coefficients begin at `first`, lowest power of x first; `first`
// moves past them.
void add_terms(int j, int low, int high, float x, float power, inout int first, inout float value)
{
    if (j > high) return;
    int least = max(low - j, 0), count = high - j - least;
    float part = horner(first, count, x);
    for (int i = 0; i < least; ++i) part *= x;
    value += power * part;
    first += count + 1;
}

// Terms of an even polynomial of total degrees `low` to `high`, which follow a row's other numbers by powers of y, then of x.
// Written out, as `load_row`: Mesa unrolls no loop that holds other loops.
float higher(int first, int low, int high, float x, float y2)
{
    float value = 0.0, y4 = y2 * y2, y8 = y4 * y4;
    add_terms(0, low, high, x, 1.0, first, value);
    add_terms(2, low, high, x, y2, first, value);
    add_terms(4, low, high, x, y4, first, value);
    add_terms(6, low, high, x, y4 * y2, first, value);
    add_terms(8, low, high, x, y8, first, value);
    add_terms(10, low, high, x, y8 * y2, first, value);
    add_terms(12, low, high, x, y8 * y4, first, value);
    return value;
}
#endif
#if SLOPE_DEGREE >= 7
float slope_t(float x, float y2)
{
    const int i = SLOPE_T;
    float value = horner(i, 7, x) + y2 * (horner(i + 8, 5, x) + y2 * (horner(i + 14, 3, x) + y2 * horner(i + 18, 1, x)));
#if SLOPE_DEGREE > 7
    value += higher(HIGHER, 8, SLOPE_DEGREE, x, y2);
#endif
    return value;
}
float slope_s(float x, float y2)
{
    const int i = SLOPE_S;
    float value = horner(i, 6, x) + y2 * (horner(i + 7, 4, x) + y2 * (horner(i + 12, 2, x) + y2 * row[i + 15]));
#if SLOPE_DEGREE > 7
    const int tangential = (SLOPE_DEGREE + 1) * (SLOPE_DEGREE + 3) / 4 - 20;  // terms before these
    value += higher(HIGHER + tangential, 7, SLOPE_DEGREE - 1, x, y2);
#endif
    return value;
}
#else
float slope_t(float x, float y2)
{
    const int i = SLOPE_T;
    return horner(i, 5, x) + y2 * (horner(i + 8, 3, x) + y2 * horner(i + 14, 1, x));
}
float slope_s(float x, float y2)
{
    const int i = SLOPE_S;
    return horner(i, 4, x) + y2 * (horner(i + 7, 2, x) + y2 * row[i + 12]);
}
#endif
#if PUPIL_DEGREE == 5
float pupil_t(float x, float y2)
{
    const int i = PUPIL_T;
    return horner(i, 5, x) + y2 * (horner(i + 6, 3, x) + y2 * horner(i + 10, 1, x));
}
float pupil_s(float x, float y2) { return even4(PUPIL_S, x, y2); }
#else
float pupil_t(float x, float y2) { return horner(PUPIL_T, 3, x) + y2 * horner(PUPIL_T + 6, 1, x); }
float pupil_s(float x, float y2) { return horner(PUPIL_S, 2, x) + y2 * row[PUPIL_S + 5]; }
#endif
