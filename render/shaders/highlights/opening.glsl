// How much light passes the pupil around a point, as the tracer's rays have it in the mean: iris, rims, and weights of the table.
// Averaged over a cell of the pupil, or over a pixel and a highlight, boxes of `scale` and `side` layer pixels: at nine points, each with a
// ramp for edges (or a coarser level of the iris's image) that has what is left of the boxes' variance.

uniform int places;             // 9; not a constant, as `probes`
#ifdef SHAPED_IRIS
uniform sampler2D iris_levels;  // transmission relative to its mean on the disc, over the square of half side 2 around it, with mipmaps
uniform vec2 iris_mean;         // of the light's place on the disc
uniform vec3 iris_squares;      // means of x², xy and y²
#endif

#ifdef SHAPED_IRIS
// Transmission at a point of the stop, in the picture's frame; `width`: of the average, on the stop.
float iris_at(vec2 point, float width)
{
    float texels = 0.25 * float(textureSize(iris_levels, 0).x) * width;
    return textureLod(iris_levels, 0.5 + 0.25 * point, log2(texels * 0.57735)).r;  // a level's tent has 3 times a box's variance
}
#endif

// Share of an edge that is open; `inside`: distance to it in units of which the ramp takes `width`.
float edge_share(float inside, float width)
{
    return clamp(0.5 + inside / width, 0.0, 1.0);
}

// The same of the unit circle, whose curvature brings the mean over the boxes outward.
float circle_share(vec2 at, float width)
{
    return edge_share(1.0 - length(at) - width * width / 24.0, width);
}

#ifdef POLYNOMIAL_LENS
// Clearances of both rims near l, above 0 blocked, and their derivatives by l, one in each column.
void rims_at(vec2 l, out vec2 clearance, out mat2 slopes)
{
    vec2 by_x = vec2(0.0), by_y = vec2(0.0);
    for (int i = 0; i < probes; ++i) {
        vec2 way = (2.0 * float(i & 1) - 1.0) * vec2(float(i == 1 || i == 2), float(i > 2)), at = l + PUPIL_STEP * way;
        vec2 rims = vec2(even4(FRONT_RIM, at.x, at.y * at.y), even4(REAR_RIM, at.x, at.y * at.y));
        if (i == 0) clearance = rims;
        by_x += way.x * rims;
        by_y += way.y * rims;
    }
    slopes = transpose(mat2(by_x, by_y)) / (2.0 * PUPIL_STEP);
}

// Light of a ray relative to that of the whole disc's mean, where the tracer scales by it.
float relative_weight(PixelRays rays, float weight)
{
    if (row[REGION + 3] > 0.0) return weight;
    float mean_weight = row[WEIGHT] + 0.25 * (row[WEIGHT + 2] + row[WEIGHT + 3]);
#ifdef SHAPED_IRIS
    vec2 along = rays.outward, across = vec2(-along.y, along.x);
    mat2 squares = mat2(iris_squares.xy, iris_squares.yz);
    mean_weight = row[WEIGHT] + row[WEIGHT + 1] * dot(iris_mean, along) + row[WEIGHT + 2] * dot(along, squares * along)
                + row[WEIGHT + 3] * dot(across, squares * across);
#endif
    return mean_weight > 0.0 ? row[LIGHT] * weight / mean_weight : weight;
}
#endif

// Share of a box around pupil point l that is open. The box has the columns of `pupil_from_box` as its sides, `side` times as long; the
// ramp of an edge is `ramp` times as long. `in_disc`: what is beyond the disc is blocked; else nothing of the box is beyond it.
float open_share(PixelRays rays, vec2 l, mat2 pupil_from_box, float side, float ramp, bool in_disc)
{
    mat2 steepness = transpose(pupil_from_box);
    float disc_width = ramp * length(steepness * (l / max(length(l), 1e-6))), share = 0.0;
    vec2 on = l / max(1.0, length(l));
#ifdef SHAPED_IRIS
    float iris_width = ramp * max(length(pupil_from_box[0]), length(pupil_from_box[1]));
#endif
#ifdef POLYNOMIAL_LENS
    bool clipped = row[REGION + 3] > 0.0;
    vec2 along = rays.outward, across = vec2(-along.y, along.x);
    vec2 region = vec2(row[REGION + 1], row[REGION + 2]), on_stop = vec2(row[REGION], 0.0) + region * l;
    float stop_width = ramp * length(steepness * (region * on_stop / max(length(on_stop), 1e-6)));
    vec2 clearance;
    mat2 slopes;
    rims_at(on, clearance, slopes);
    vec2 rim_width = ramp * max(vec2(length(steepness * slopes[0]), length(steepness * slopes[1])), 1e-6);
#endif
    for (int i = 0; i < places; ++i) {
        vec2 at = l + pupil_from_box * (side / 3.0 * (vec2(i % 3, i / 3) - 1.0));
        float open = in_disc ? circle_share(at, disc_width) : 1.0;
#ifdef POLYNOMIAL_LENS
        if (clipped) {
            vec2 stop = vec2(row[REGION], 0.0) + region * at, past = clearance + (at - on) * slopes;
            open = min(min(open, circle_share(stop, stop_width)),
                       min(edge_share(-past.x, rim_width.x), edge_share(-past.y, rim_width.y)));
#ifdef SHAPED_IRIS
            open *= iris_at(stop.x * along + stop.y * across, iris_width * max(region.x, region.y));
#endif
            share += open;
            continue;
        }
#endif
#if defined(SHAPED_IRIS) && defined(POLYNOMIAL_LENS)
        open = iris_at(at.x * along + at.y * across, iris_width);
#elif defined(SHAPED_IRIS)
        open = iris_at(at, iris_width);
#endif
        share += open;
    }
    return share / float(places);
}

// Weight of a ray from the table, relative to that of an even disc's.
float light_weight(PixelRays rays, float weight)
{
#ifdef POLYNOMIAL_LENS
    return relative_weight(rays, max(weight, 0.0));
#else
    return weight;
#endif
}

// Density of the light at pupil point l relative to an even disc's, averaged over pixel and highlight; `weight`: the table's.
float light_at(PixelRays rays, vec2 l, float weight, mat2 pupil_from_layers, float side)
{
    float wide = max(scale, side), narrow = min(scale, side), ramp = sqrt(narrow * narrow + wide * wide / 9.0);
    return open_share(rays, l, pupil_from_layers, wide, ramp, true) * light_weight(rays, weight);
}
