#version 450 core
// Quad over the pixels that get the light of a splat: of one pixel, or of a square of like pixels drawn as one.
// in:  list of splats, one for each instance; the field that they belong to
// out: light of the splat, and the fragment's pixel and table

#include "scatter/scatter.glsl"

layout(std430, binding = 1) readonly buffer Spots { uint spots[]; };

uniform isampler2D reaches;     // reach of each table in pixels
uniform int first;              // first splat of the list
uniform int steps;              // tables of pixels; as many follow for squares of 2, 4 and 8 of them
uniform int middle;             // middle pixel of the tables
uniform vec2 target_px;

flat out vec4 point_light;
flat out ivec2 corner;          // pixel of the target where the table begins
flat out int table;             // number of the smaller table
flat out float next;            // weight of the next larger table

void main()
{
    uint spot = spots[first + gl_InstanceID];
    ivec2 at = ivec2(spot & 0x7fffu, spot >> 15 & 0x7fffu);
    int log_side = int(spot >> 30), side = 1 << log_side;
    float c = 0.0;
    point_light = vec4(0.0);
    for (int i = 0; i < side * side; ++i) {
        ivec2 pixel = at + ivec2(i % side, i / side);
        point_light += texelFetch(light, pixel, 0);
        c += texelFetch(radii, pixel, 0)[channel];
    }
    c /= float(side * side);
    if (side == 1) point_light *= 1.0 - sharp_share(c);
    float size_step = min(c * STEPS, float(steps - 2));
    table = int(size_step) + log_side * steps;
    next = fract(size_step);
    int reach = max(texelFetch(reaches, ivec2(table, 0), 0).r, texelFetch(reaches, ivec2(table + 1, 0), 0).r);
    ivec2 middle_at = at + side / 2, from = middle_at - reach, size = ivec2(2 * reach + (side > 1 ? 0 : 1));
    corner = middle_at - middle;
    vec2 place = vec2(from + ivec2(gl_VertexID & 1, gl_VertexID >> 1) * size);
    gl_Position = vec4(place / target_px * 2.0 - 1.0, 0.0, 1.0);
}
