#version 450 core
// Naive gather: each pixel samples the whole square within the greatest radius and sums the intensity of every pixel whose
// circle of confusion reaches it.
// in:  intensity and radius of each pixel (flag/point_spread.comp)
// out: `blurred`: light and coverage of the field, in a rectangle
// Moersch & Hamilton 2014, section 3.1, with no spacing. Quadratic in the radius.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D blurred;

#include "layers/outline.glsl"

uniform sampler2D intensity;
uniform sampler2D radii;
uniform ivec2 first;        // pixel of the rectangle
uniform ivec2 piece_px;     // its size
uniform ivec2 most;         // greatest distance in pixels, across and down

// Share of the pixel `steps` above or below a column's middle that lies within this extent of it.
float share_below(float extent, int steps)
{
    return extent < 0.5 ? 0.0 : clamp(extent + 0.5 - float(steps), 0.0, 1.0);
}

// Share of a pixel's intensity on another, `dx` to the right of it and `dy` below: along a column, the last pixel of the circle
// gets its share.
float share_at(int dx, int dy, float radius)
{
    vec2 extents = reach_at(float(dx), radius);
    if (dy == 0) {
        vec4 halves = clamp(2.0 * vec4(extents, -extents), 0.0, 1.0);
        return 0.5 * (halves.x + halves.y - halves.z - halves.w);
    }
    if (dy > 0) extents = extents.yx;
    return share_below(extents.x, abs(dy)) - share_below(-extents.y, abs(dy));
}

void main()
{
    ivec2 within = ivec2(gl_GlobalInvocationID.xy), at = first + within, size = imageSize(blurred);
    if (any(greaterThanEqual(within, piece_px))) return;
    ivec2 low = max(at - most, ivec2(0)), high = min(at + most, size - 1);
    vec4 total = vec4(0.0);
    for (int y = low.y; y <= high.y; ++y) {
        for (int x = low.x; x <= high.x; ++x) {
            float radius = texelFetch(radii, ivec2(x, y), 0).r;
            ivec2 off = at - ivec2(x, y);
            if (radius <= 0.0 || !has_column(off.x, radius)) continue;
            float share = share_at(off.x, off.y, radius);
            if (share > 0.0) total += share * texelFetch(intensity, ivec2(x, y), 0);
        }
    }
    imageStore(blurred, at, total);
}
