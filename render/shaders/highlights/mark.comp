#version 450 core
// Mark the texels of layers that are highlights: far brighter than what is around them, and so blurred that rays miss them mostly.
// in:  layers (march.glsl), means
// out: for each block of 8x8 texels and each layer 64 bits in `marks`, row after row; they are 0 before

#include "trace/march.glsl"
#include "highlights/surroundings.glsl"
#include "highlights/pixel_focus.glsl"
#include "highlights/texel.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) buffer Marks { uint marks[]; };

uniform int layer_count;
uniform ivec2 block_count;      // of the layers
uniform int first_row;          // of blocks of this dispatch
uniform float blur_px;          // circle of confusion at a difference of 1/m, layer pixels
uniform float least_radius;     // layer pixels
uniform float noise;            // standard deviation of a pixel relative to its surroundings from which a texel is a highlight
uniform float rays;             // rays per pixel

// `least`: luminance that the surroundings of any texel have at least.
bool is_highlight(ivec2 texel, int layer, float w, float least)
{
    Seen seen = seen_texel(texel, layer, abs(w));
    vec2 focused = focus_at((seen.place - offset) / scale);
    float radius = blur_px * focused.y * abs(seen.w - focused.x);
    if (seen.w == 0.0 || radius < least_radius) return false;
    float light = luminance_of(texelFetch(radiance, ivec3(texel, layer), 0), w);
    if (light <= 2.0 * least) return false;
    float around = luminance_around(texel, radius);
    // a ray finds the texel with probability 1 over the area of its circle of confusion and the pixel
    float excess = light - around, hits = rays * (3.14159 * radius * radius + scale * scale);
    if (excess <= around || excess * excess <= noise * noise * around * around * hits) return false;
    return true;
}

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, 8 * first_row);
    bool inside = all(lessThan(texel, textureSize(packed_w, 0)));
    uint place = gl_LocalInvocationIndex, blocks = uint(block_count.x * block_count.y);
    uint block = (uint(first_row) + gl_WorkGroupID.y) * uint(block_count.x) + gl_WorkGroupID.x;
    float least = least_luminance_around();
    for (int layer = 0; layer < layer_count; ++layer) {
        float w = inside ? stored_w(texel, layer) : 0.0;
        if (w == 0.0) break;  // the layers behind are empty too
        if (is_highlight(texel, layer, w, least)) {
            atomicOr(marks[2u * (uint(layer) * blocks + block) + (place >> 5)], 1u << (place & 31u));
        }
    }
}
