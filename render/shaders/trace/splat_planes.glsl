// Planes of splats that a ray passes, near to far: each holds the splats of a range of w, drawn from the pupil's centre, and is met at
// one w. A ray meets a plane at s(w) = a + b·w, as it meets surfaces.

const int MOST_PLANES = 32;     // MOST_PLANES of render/trace/splats/bins.py

uniform sampler2DArray splat_planes;    // premultiplied radiance and opacity
uniform int splat_count;
uniform vec2 splat_scale;               // texture coordinates per layer pixel
uniform vec2 splat_corner;              // layer pixel at their corner, counted in the whole picture's layers
uniform vec2 splat_places[MOST_PLANES]; // w of a plane, and the nearest w of its splats, 1/m

const float LEAST_PASSED = 1e-3;
#ifdef HELD_SPLATS
const int SHARES = 2;                   // slices of a plane before those of shares: its light, and the opacity of holdouts
#else
const int SHARES = 1;
#endif

#ifdef MATTES
const int MOST_CLOUDS = 15;             // MOST_MATTE_CLOUDS of render/model/splats.py
uniform int cloud_count;                // of several, three have a slice behind those of all planes: their shares in the opacity
uniform uint cloud_numbers[MOST_CLOUDS];    // 0 of holdouts

// Note what the clouds of a plane add to the ray's light and coverage.
void note_clouds(vec2 at, int plane, vec4 light)
{
    float w = splat_places[plane].x;
    if (cloud_count == 1) {
        if (cloud_numbers[0] != 0u) note(cloud_numbers[0], light, w);
        return;
    }
    for (int i = 0; i < cloud_count; i += 3) {
        vec4 held = textureLod(splat_planes, vec3(at, float((SHARES + i / 3) * splat_count + plane)), 0.0);
        for (int k = 0; k < 3 && i + k < cloud_count; ++k)
            if (cloud_numbers[i + k] != 0u) note(cloud_numbers[i + k], light * held[k] / max(held.a, 1e-6), w);
    }
}
#endif

// Composite the planes in front of w, from the next one on, behind what was met.
void pass_planes(vec2 a, vec2 b, float w, inout int plane, inout vec4 seen, inout float passing)
{
    for (; plane < splat_count && splat_places[plane].y > w && passing > LEAST_PASSED; ++plane) {
        vec2 at = (a + b * splat_places[plane].x - splat_corner) * splat_scale;
        vec4 light = textureLod(splat_planes, vec3(at, float(plane)), 0.0);
#ifdef MATTES
        if (light.a > 0.0) note_clouds(at, plane, passing * light);
#endif
        seen += passing * light;
#ifdef HELD_SPLATS
        seen.a -= passing * textureLod(splat_planes, vec3(at, float(splat_count + plane)), 0.0).r;
#endif
        passing *= 1.0 - light.a;
    }
}
