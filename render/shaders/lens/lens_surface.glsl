// Surfaces of a lens: intersection and refraction of rays.
// Lengths in mm; z along the axis from the scene to the film, 0 at the surface's vertex. Rays here go from the film to the scene.

struct LensSurface {
    vec4 shape;         // curvature (1/mm), half clear diameter (negative at the stop), conic constant, distance to the next vertex or the film
    vec4 aspheric[3];   // coefficients of r^4, r^6, ... r^26
    vec4 kind;          // number of aspheric coefficients, 1 + index of its height map (0 for none), lowest and highest height
#ifdef BICONIC
    vec4 across;        // curvature (1/mm) and conic constant from side to side; 1 where they are others than from top to bottom; of a
                        // torus 1 where the curve from top to bottom is turned, 2 where that from side to side is
#endif
#ifdef OUTLINES
    vec4 opening;       // half width (negative of a rectangle, 0 where there is none), half height, centre
    vec4 obscuration;   // likewise
#endif
#ifdef POLYGONS
    vec4 corners;       // first corner and number of corners of the opening, and of the obscuration; 0 corners of another shape
#endif
#ifdef ODD_POWERS
    vec4 odd[3];        // coefficients of r^3, r^5, ... r^23; 0 beyond those it has
    vec4 odd_count;     // their number
#endif
#ifdef PHASES
    vec4 phase[3];      // coefficients of r^2, r^4, ... r^20 of the phase that it adds, radians; 0 beyond those it has
    vec4 phase_count;   // their number
#endif
};
layout(std430, binding = 0) readonly buffer LensSurfaces { LensSurface surfaces[]; };

#ifdef POLYGONS
layout(std430, binding = 4) readonly buffer Corners { vec2 corners[]; };
#endif

#ifdef HEIGHT_FIELD
uniform sampler2D heights[2];   // mm toward the film, over the square around the clear aperture, row 0 at the top
const int MARCH_STEPS = 64;
const int REFINEMENTS = 14;
#endif

// Polynomial part of the sag and its derivative by r², at r².
vec2 aspheric_sag(LensSurface s, float r2)
{
    float sag = 0.0, slope = 0.0;
    for (int i = int(s.kind.x) - 1; i >= 0; --i) {
        slope = slope * r2 + sag;
        sag = sag * r2 + s.aspheric[i >> 2][i & 3];
    }
    vec2 whole = vec2(sag * r2 * r2, slope * r2 * r2 + 2.0 * sag * r2);
#ifdef ODD_POWERS
    float r = sqrt(r2), odd = 0.0, odd_slope = 0.0;
    for (int i = int(s.odd_count.x) - 1; i >= 0; --i) {
        odd_slope = odd_slope * r2 + odd;
        odd = odd * r2 + s.odd[i >> 2][i & 3];
    }
    whole += r * vec2(odd * r2, odd_slope * r2 + 1.5 * odd);
#endif
    return whole;
}

#ifdef TORIC
// Sag and its gradient of a torus; false where it does not go.
bool torus_at(LensSurface s, vec2 at, out float sag, out vec2 gradient)
{
    bool stands = s.across.w == 1.0;
    vec2 place = stands ? at.yx : at;   // along the curve that is turned, and beside it
    float c = stands ? s.shape.x : s.across.x, conic = stands ? s.shape.z : s.across.y, turn = stands ? s.across.x : s.shape.x;
    float square = place.x * place.x, inside = 1.0 - (1.0 + conic) * c * c * square;
    if (inside <= 0.0) return false;
    float root = sqrt(inside);
    vec2 curve = vec2(c * square / (1.0 + root), 0.5 * c / root) + aspheric_sag(s, square);
    float near = 1.0 - turn * curve.x, left = near * near - turn * turn * place.y * place.y;
    if (near <= 0.0 || left <= 0.0) return false;
    left = sqrt(left);
    sag = curve.x + turn * place.y * place.y / (near + left);
    vec2 slopes = vec2(2.0 * place.x * curve.y * near, turn * place.y) / left;
    gradient = stands ? slopes.yx : slopes;
    return true;
}
#endif

// Sag and its gradient; false beyond the surface's own rim.
bool sag_at(LensSurface s, vec2 at, out float sag, out vec2 gradient)
{
#ifdef TORIC
    if (s.across.w > 0.0) return torus_at(s, at, sag, gradient);
#endif
    float r2 = dot(at, at);
#ifdef BICONIC
    vec2 c = vec2(s.across.x, s.shape.x), bend = (1.0 + vec2(s.across.y, s.shape.z)) * c * c;
    float curved = dot(c, at * at), inside = 1.0 - dot(bend, at * at);
#else
    float c = s.shape.x, curved = c * r2, inside = 1.0 - (1.0 + s.shape.z) * c * c * r2;
#endif
    if (inside <= 0.0) return false;
    float root = sqrt(inside);
    vec2 polynomial = aspheric_sag(s, r2);
    sag = curved / (1.0 + root) + polynomial.x;
#ifdef BICONIC
    gradient = at * (2.0 * c / (1.0 + root) + curved * bend / (root * (1.0 + root) * (1.0 + root)) + 2.0 * polynomial.y);
#else
    gradient = at * (c / root + 2.0 * polynomial.y);
#endif
#ifdef HEIGHT_FIELD
    if (s.kind.y > 0.0) {
        vec2 place = 0.5 + 0.5 * vec2(at.x, -at.y) / abs(s.shape.y);
        int map = int(s.kind.y) - 1;
        vec2 texel = 1.0 / vec2(textureSize(heights[map], 0));
        sag += textureLod(heights[map], place, 0.0).r;
        float x = textureLod(heights[map], place + vec2(texel.x, 0.0), 0.0).r
                - textureLod(heights[map], place - vec2(texel.x, 0.0), 0.0).r;
        float y = textureLod(heights[map], place - vec2(0.0, texel.y), 0.0).r
                - textureLod(heights[map], place + vec2(0.0, texel.y), 0.0).r;
        gradient += vec2(x, y) / (4.0 * abs(s.shape.y) * texel);
    }
#endif
    return true;
}

// Distance along the ray to the conic; the root on the vertex's side.
bool meet_conic(LensSurface s, vec3 o, vec3 d, out float t)
{
    float c = s.shape.x, k = 1.0 + s.shape.z;
    float A = c * (dot(d.xy, d.xy) + k * d.z * d.z);
    float B = c * (dot(o.xy, d.xy) + k * o.z * d.z) - d.z;
    float C = c * (dot(o.xy, o.xy) + k * o.z * o.z) - 2.0 * o.z;
    float discriminant = B * B - A * C;
    if (discriminant < 0.0) return false;
    t = C / (-B + sign(d.z) * sqrt(discriminant));
    return true;
}

// Distance, along z, of a point of the ray behind the surface.
float behind(LensSurface s, vec3 p)
{
    float sag;
    vec2 gradient;
    return sag_at(s, p.xy, sag, gradient) ? p.z - sag : 1e9;
}

#ifdef HEIGHT_FIELD
// March through the slab that contains the surface, then bisect the step in which the ray crosses it. The slab follows from the sag
// at the rim and the lowest and highest height.
bool meet_heights(LensSurface s, vec3 o, vec3 d, out float t)
{
    float rim = behind(s, vec3(abs(s.shape.y), 0.0, 0.0));
    if (abs(rim) >= 1e8) return false;
    float top = max(0.0, -rim - s.kind.z) + s.kind.w, bottom = min(0.0, -rim - s.kind.w) + s.kind.z;
    float first = (top + 1e-4 - o.z) / d.z, last = (bottom - 1e-4 - o.z) / d.z, step_t = (last - first) / float(MARCH_STEPS);
    float before = first;
    t = first;
    for (int i = 1; i <= MARCH_STEPS; ++i) {
        t = first + step_t * float(i);
        if (behind(s, o + t * d) <= 0.0) break;
        before = t;
        if (i == MARCH_STEPS) return false;
    }
    for (int i = 0; i < REFINEMENTS; ++i) {
        float middle = 0.5 * (before + t);
        if (behind(s, o + middle * d) <= 0.0) t = middle;
        else before = middle;
    }
    return true;
}
#endif

// Distance to the surface: closed form for the conic, then Newton's method for its aspheric terms, second curve and heights.
bool meet(LensSurface s, vec3 o, vec3 d, out float t)
{
#ifdef HEIGHT_FIELD
    if (s.kind.y > 0.0) return meet_heights(s, o, d, t);
#endif
#ifdef BICONIC
    bool is_conic = s.across.z == 0.0;
#else
    const bool is_conic = true;
#endif
    if (is_conic) {
        if (!meet_conic(s, o, d, t)) return false;
#ifdef ODD_POWERS
        if (s.kind.x == 0.0 && s.odd_count.x == 0.0) return true;
#else
        if (s.kind.x == 0.0) return true;
#endif
    } else {
        t = -o.z / d.z;
    }
    for (int i = 0; i < 8; ++i) {
        vec3 p = o + t * d;
        float sag;
        vec2 gradient;
        if (!sag_at(s, p.xy, sag, gradient)) return false;
        t -= (p.z - sag) / (d.z - dot(gradient, d.xy));
    }
    return true;
}

#ifdef OUTLINES
// Square of the distance from an outline's centre over that of its edge in the same direction, less 1: above 0 outside.
float excess(vec4 outline, vec2 at)
{
    vec2 squares = (at - outline.zw) / outline.xy;
    squares *= squares;
    return (outline.x < 0.0 ? max(squares.x, squares.y) : squares.x + squares.y) - 1.0;
}
#endif

#ifdef PHASES
// Direction behind a diffractive surface; zero where the order does not exist.
vec3 diffract(LensSurface s, vec2 at, vec3 d, vec3 normal, float ratio, float reduced)
{
    float r2 = dot(at, at), slope = 0.0;
    for (int i = int(s.phase_count.x) - 1; i >= 0; --i) slope = slope * r2 + float(i + 1) * s.phase[i >> 2][i & 3];
    vec3 going = ratio * d + vec3(reduced * 2.0 * slope * at, 0.0);
    float along = dot(going, normal), squared = 1.0 - dot(going, going) + along * along;
    if (squared < 0.0) return vec3(0.0);
    return normalize(going + (sign(dot(d, normal)) * sqrt(squared) - along) * normal);
}
#endif

#ifdef POLYGONS
// Twice the distance from the edge of a polygon over the smaller of its half sizes, negative within it.
float polygon_excess(vec2 half_size, int first, int count, vec2 at)
{
    float square = 1e30, way = 1.0;
    for (int i = 0; i < count; ++i) {
        vec2 begin = corners[first + i], end = corners[first + (i + 1) % count];
        vec2 edge = end - begin, to_point = at - begin;
        vec2 off = to_point - edge * clamp(dot(to_point, edge) / max(dot(edge, edge), 1e-30), 0.0, 1.0);
        square = min(square, dot(off, off));
        bool spans = (begin.y <= at.y) != (end.y <= at.y);
        bool is_left = edge.x * to_point.y > edge.y * to_point.x;
        if (spans && is_left == (edge.y > 0.0)) way = -way;
    }
    return 2.0 * way * sqrt(square) / min(half_size.x, half_size.y);
}
#endif

// Refract a ray at one surface: `o` moves onto it, `d` is refracted (Snell), `clearance` grows to (r / half diameter)² - 1, or to
// that of the surface's opening or obscuration.
bool refract_at(LensSurface s, float from_index, float to_index, inout vec3 o, inout vec3 d, inout float clearance
#ifdef PHASES
                , float reduced     // wavelength in air over 2π, mm
#endif
                )
{
    float t, sag;
    vec2 gradient;
    if (!meet(s, o, d, t)) return false;
    o += t * d;
    if (!sag_at(s, o.xy, sag, gradient)) return false;
    if (s.shape.y > 0.0) clearance = max(clearance, dot(o.xy, o.xy) / (s.shape.y * s.shape.y) - 1.0);
#ifdef OUTLINES
    float open = s.opening.x != 0.0 ? excess(s.opening, o.xy) : -1.0;
    float obscured = s.obscuration.x != 0.0 ? excess(s.obscuration, o.xy) : 1.0;
#ifdef POLYGONS
    if (s.corners.y > 0.0) open = polygon_excess(s.opening.xy, int(s.corners.x), int(s.corners.y), o.xy);
    if (s.corners.w > 0.0) obscured = polygon_excess(s.obscuration.xy, int(s.corners.z), int(s.corners.w), o.xy);
#endif
    clearance = max(clearance, max(open, -obscured));
#endif
    vec3 normal = normalize(vec3(-gradient, 1.0));
#ifdef PHASES
    if (s.phase_count.x > 0.0) {
        d = diffract(s, o.xy, d, normal, from_index / to_index, reduced / to_index);
        return d != vec3(0.0);
    }
#endif
    if (from_index == to_index) return true;
    d = refract(d, normal, from_index / to_index);
    return d != vec3(0.0);
}
