#version 450 core
// Plan the splats: single pixels, or squares of 2, 4 or 8 like pixels whose spots are much larger than they are.
// in:  a field's light and circles of confusion
// out: `plan`, at the upper left pixel of a splat: 1 + its class + CLASSES · log2 of its side; 0 for none.
//      `counts` of splats, by class and work group
// A class is a range of circles of confusion that is drawn together.

layout(local_size_x = 8, local_size_y = 8) in;
layout(r8ui, binding = 0) uniform writeonly uimage2D plan;
layout(std430, binding = 0) writeonly buffer Counts { uint counts[]; };

#include "scatter/scatter.glsl"

uniform vec4 edges;             // circles of confusion at which classes begin, and the last one ends

shared vec4 totals[64];         // light of the square at this pixel
shared vec2 spans[64];          // least and greatest circle of confusion in it
shared int plans[64];           // class + CLASSES · log2 of the side of the square at this pixel; -1 for none
shared uint waiting;            // whether the work group draws anything
shared uint planned_bits[2 * CLASSES]; // by class, a bit for each invocation

// Whether the square's halves have so similar light that the square's middle may represent it.
bool is_alike(vec4 one, vec4 other, float side, float px)
{
    vec4 shift = 0.25 * side * abs(one - other), most = min(SHIFT * px, MOST_SHIFT) * (one + other);
    return all(lessThanEqual(shift, most + 1e-9));
}

bool can_merge(int lane, int half_side)
{
    int right = lane + half_side, below = lane + 8 * half_side, across = below + half_side;
    int own = plans[lane];
    if (own < 0 || plans[right] != own || plans[below] != own || plans[across] != own) return false;
    vec2 span = vec2(min(min(spans[lane].x, spans[right].x), min(spans[below].x, spans[across].x)),
                     max(max(spans[lane].y, spans[right].y), max(spans[below].y, spans[across].y)));
    float px = min(spot_px(span.x), spot_px(span.y)), side = float(2 * half_side);
    if (px < WIDER * side || span.y - span.x > 0.5 + SPAN * px) return false;
    return is_alike(totals[lane] + totals[below], totals[right] + totals[across], side, px)
        && is_alike(totals[lane] + totals[right], totals[below] + totals[across], side, px);
}

void merge(int lane, int half_side)
{
    int right = lane + half_side, below = lane + 8 * half_side, across = below + half_side;
    totals[lane] += totals[right] + totals[below] + totals[across];
    spans[lane].x = min(min(spans[lane].x, spans[right].x), min(spans[below].x, spans[across].x));
    spans[lane].y = max(max(spans[lane].y, spans[right].y), max(spans[below].y, spans[across].y));
    plans[lane] += CLASSES;
    plans[right] = plans[below] = plans[across] = -1;
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy), size = textureSize(light, 0), local = ivec2(gl_LocalInvocationID.xy);
    int lane = int(gl_LocalInvocationIndex), own = -1;
    bool is_inside = all(lessThan(at, size));
    if (lane < 2 * CLASSES) planned_bits[lane] = 0u;
    totals[lane] = vec4(0.0);
    spans[lane] = vec2(0.0);
    if (is_inside) {
        float c = texelFetch(radii, at, 0)[channel];
        totals[lane] = texelFetch(light, at, 0);
        spans[lane] = vec2(c);
        if (totals[lane].a > 0.0 && c < edges.w && sharp_share(c) < 1.0) {
            own = 0;
            for (int kind = 1; kind < CLASSES; ++kind) if (c >= edges[kind]) own = kind;
        }
    }
    plans[lane] = own;
    if (lane == 0) waiting = 0u;
    barrier();
    if (own >= 0) atomicOr(waiting, 1u);
    barrier();
    if (waiting != 0u) {
        for (int level = 0; level < 3; ++level) {
            int half_side = 1 << level;
            bool leads = all(equal(local & ivec2(2 * half_side - 1), ivec2(0))) && plans[lane] / CLASSES == level;
            if (leads && can_merge(lane, half_side)) merge(lane, half_side);
            barrier();
        }
        own = plans[lane];
        if (own >= 0) atomicOr(planned_bits[2 * (own % CLASSES) + (lane >> 5)], 1u << (lane & 31));
    }
    if (is_inside) imageStore(plan, at, uvec4(own + 1, 0u, 0u, 0u));
    barrier();
    int groups = int(gl_NumWorkGroups.x * gl_NumWorkGroups.y);
    if (lane < CLASSES) {
        int group = int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
        counts[lane * groups + group] = uint(bitCount(planned_bits[2 * lane]) + bitCount(planned_bits[2 * lane + 1]));
    }
}
