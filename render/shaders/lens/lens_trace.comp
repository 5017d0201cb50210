#version 450 core
// Trace rays from the film through chosen points of the stop and out into the scene, surface by surface.
// in:  film and stop points (mm); the lens's surfaces (lens_surface.glsl); refractive indices, before the first surface and behind
//      each, for each wavelength
// out: slope in object space (x per depth) and the ray's point in the entrance pupil's plane (mm); clearances before and behind
//      the stop (above 0 blocked); weight, d(direction cosines on the film) / d(stop point), 1/mm²; 1 where the ray passes
// Kolb, Mitchell & Hanrahan 1995, section 3.1, with rays aimed at the stop; the weight is the projected solid angle of a stop
// element seen from the film, which includes the cos⁴ law, once.

layout(local_size_x = 64) in;

#include "lens/lens_surface.glsl"

layout(std430, binding = 1) readonly buffer Indices { float indices[]; };
layout(std430, binding = 2) readonly buffer Queries { vec4 queries[]; };  // film xy, stop xy
struct Traced { vec4 ray; vec4 light; };
layout(std430, binding = 3) writeonly buffer Results { Traced results[]; };

uniform int query_count;
uniform int surface_count;
uniform int stop_index;
uniform float entrance_mm;      // distance from the front vertex to the entrance pupil
uniform float stop_mm;          // radius of the stop
#ifdef PHASES
uniform float reduced[MAX_WAVELENGTHS]; // wavelengths over 2π, mm
#endif
uniform vec2 to_stop[MAX_WAVELENGTHS];  // near the axis, stop point = x · film point + y · slope

const int NEWTON_STEPS = 6;

struct Path { vec3 o; vec3 d; float clearance; };

bool through(int first, int last, int wavelength, inout Path path)
{
    for (int i = first; i >= last; --i) {
        path.o.z += surfaces[i].shape.w;
        int index = wavelength * (surface_count + 1) + i;
#ifdef PHASES
        if (!refract_at(surfaces[i], indices[index + 1], indices[index], path.o, path.d, path.clearance, reduced[wavelength])) return false;
#else
        if (!refract_at(surfaces[i], indices[index + 1], indices[index], path.o, path.d, path.clearance)) return false;
#endif
    }
    return true;
}

// Trace from the film to the stop; `at` is the ray's point in the plane of the stop's vertex.
bool reach_stop(vec2 film, vec2 slope, int wavelength, out Path path, out vec2 at)
{
    path = Path(vec3(film, 0.0), normalize(vec3(slope, -1.0)), -1.0);
    at = vec2(0.0);
    if (!through(surface_count - 1, stop_index + 1, wavelength, path)) return false;
    at = path.o.xy - path.d.xy * ((path.o.z + surfaces[stop_index].shape.w) / path.d.z);
    return true;
}

// Newton's method for the slope at the film that takes the ray through the stop point; `det` is d(stop point)/d(slope).
bool aim(vec2 film, vec2 stop, int wavelength, out vec2 slope, out float det, out Path path)
{
    vec2 near_axis = to_stop[wavelength];
    float h = 0.02 * stop_mm / near_axis.y;
    slope = (stop - near_axis.x * film) / near_axis.y;
    for (int i = 0; i < NEWTON_STEPS; ++i) {
        vec2 at, at_x, at_y;
        if (!reach_stop(film, slope, wavelength, path, at)) return false;
        if (!reach_stop(film, slope + vec2(h, 0.0), wavelength, path, at_x)) return false;
        if (!reach_stop(film, slope + vec2(0.0, h), wavelength, path, at_y)) return false;
        vec2 dx = (at_x - at) / h, dy = (at_y - at) / h, off = stop - at;
        det = dx.x * dy.y - dx.y * dy.x;
        slope += vec2(off.x * dy.y - off.y * dy.x, dx.x * off.y - dx.y * off.x) / det;
    }
    vec2 at;
    return reach_stop(film, slope, wavelength, path, at) && distance(at, stop) < 1e-3 * stop_mm;
}

void main()
{
    int query = int(gl_GlobalInvocationID.x), wavelength = int(gl_GlobalInvocationID.y);
    if (query >= query_count) return;
    vec4 asked = queries[query];
    Traced result = Traced(vec4(0.0), vec4(1.0, 1.0, 0.0, 0.0));
    vec2 slope;
    float det;
    Path path;
    if (aim(asked.xy, asked.zw, wavelength, slope, det, path)) {
        float rear = path.clearance;
        path.clearance = -1.0;
        if (through(stop_index, 0, wavelength, path)) {  // the stop may be a surface that refracts
            vec2 out_slope = -path.d.xy / path.d.z;
            vec2 pupil = path.o.xy - out_slope * (entrance_mm - path.o.z);
            float cos2 = 1.0 / (1.0 + dot(slope, slope));
            result = Traced(vec4(out_slope, pupil), vec4(path.clearance, rear, cos2 * cos2 / abs(det), 1.0));
        }
    }
    results[wavelength * query_count + query] = result;
}
