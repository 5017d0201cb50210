// Planes of splats that a ray passes, near to far: each holds the splats of a range of w, drawn from the pupil's centre, and is met at
// one w. A ray meets a plane at s(w) = a + b·w, as it meets surfaces.

const int MOST_PLANES = 32;     // MOST_PLANES of render/trace/splats/bins.py

uniform sampler2DArray splat_planes;    // premultiplied radiance and opacity
uniform int splat_count;
uniform vec2 splat_scale;               // texture coordinates per layer pixel
uniform vec2 splat_corner;              // layer pixel at their corner, counted in the whole picture's layers
uniform vec2 splat_places[MOST_PLANES]; // w of a plane, and the nearest w of its splats, 1/m

const float LEAST_PASSED = 1e-3;

// Composite the planes in front of w, from the next one on, behind what was met.
void pass_planes(vec2 a, vec2 b, float w, inout int plane, inout vec4 seen, inout float passing)
{
    for (; plane < splat_count && splat_places[plane].y > w && passing > LEAST_PASSED; ++plane) {
        vec2 at = (a + b * splat_places[plane].x - splat_corner) * splat_scale;
        vec4 light = textureLod(splat_planes, vec3(at, float(plane)), 0.0);
        seen += passing * light;
        passing *= 1.0 - light.a;
    }
}
