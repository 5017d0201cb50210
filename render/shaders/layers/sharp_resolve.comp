#version 450 core
// Texels of the sharp layer: their surface's radiance and slope, from the texel of the layers nearby that lies on it.
// in:  depth of the nearest opaque surfaces; the layers
// out: w (1/m; 0 empty; negative where it is still to be shaded), slope, and radiance; `missing`: whether any is negative
// Chajdas, McGuire & Luebke 2011, "Subpixel reconstruction antialiasing for deferred shading", section 3.

layout(local_size_x = 8, local_size_y = 8) in;
layout(r32f, binding = 0) writeonly uniform image2D sharp_w;
layout(r16ui, binding = 1) writeonly uniform uimage2D sharp_slopes;
layout(rgba16f, binding = 2) writeonly uniform image2D sharp_radiance;
layout(std430, binding = 0) buffer Missing { uint missing; };

uniform sampler2D depth_map;
uniform sampler2D packed_w;     // layers 0 to 3
uniform usampler2D slopes;
uniform sampler2DArray radiance;
uniform vec2 w_range;           // w of depth 0 and of depth 1
uniform float half_width;       // largest difference of w from that in focus
uniform ivec2 offset;           // texel of these layers at the sharp layer's corner
uniform ivec2 first;            // the same in the layers of the whole picture

#include "trace/slopes.glsl"
#include "layers/sharp_match.glsl"
#include "layers/sharp_focus.glsl"

const float FAR_PENALTY = 0.0005;   // of a texel's distance in texels, as a relative difference of w
const float CONTRAST = 0.03;        // difference of display values between texels above which a texel is shaded

// Approximate display values of radiance.
vec3 displayed(vec3 c)
{
    return sqrt(c / (1.0 + c));
}

// Difference of the texel's w from that in focus; large where there is no surface.
float out_of_focus(ivec2 pixel)
{
    float depth = texelFetch(depth_map, clamp(pixel, ivec2(0), textureSize(depth_map, 0) - 1), 0).r;
    float w_f = w_in_focus(vec2(first) + (vec2(pixel) + 0.5) * 0.5);
    return depth > 0.0 ? abs(mix(w_range.x, w_range.y, depth) - w_f) : 1e30;
}

// Whether something is in the zone here or a texel of the layers beside. A ray that meets a surface at a texel's edge may find it
// from the texel beside, so that the sharp layer and the layers must overlap where a surface leaves the zone.
bool is_held(ivec2 pixel)
{
    float least = out_of_focus(pixel);
    for (int i = 0; i < 9 && least > half_width; ++i) least = min(least, out_of_focus(pixel + 2 * (ivec2(i % 3, i / 3) - 1)));
    return least <= half_width;
}

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(sharp_w)))) return;
    float depth = texelFetch(depth_map, pixel, 0).r, w = mix(w_range.x, w_range.y, depth);
    vec2 at = vec2(offset) + (vec2(pixel) + 0.5) * 0.5;
    float found = 0.0;
    if (depth > 0.0 && is_held(pixel)) {
        ivec2 own = offset + pixel / 2, last = textureSize(packed_w, 0) - 1, side = 2 * (pixel & 1) - 1, place = own;
        float least = 1.0;
        vec3 darkest = vec3(1.0), brightest = vec3(0.0);
        int layer = -1;
        uint slope = 0u;
        for (int i = 0; i < 4; ++i) {  // the four texels whose centres are nearest
            ivec2 there = own + side * ivec2(i & 1, i >> 1);
            if (any(lessThan(there, ivec2(0))) || any(greaterThan(there, last))) continue;
            vec2 off = at - (vec2(there) + 0.5);
            uvec4 held = texelFetch(slopes, there, 0);
            vec4 stored = texelFetch(packed_w, there, 0), errors = prediction_errors(stored, held, off, w);
            if (stored.x == 0.0) continue;  // nothing was drawn here: its radiance is undefined
            int nearest = 0;
            for (int k = 1; k < 4; ++k) nearest = errors[k] < errors[nearest] ? k : nearest;
            bool matches = errors[nearest] <= ALIKE;
            vec3 shown = displayed(texelFetch(radiance, ivec3(there, matches ? nearest : 0), 0).rgb);
            darkest = min(darkest, shown);
            brightest = max(brightest, shown);
            float error = errors[nearest] + FAR_PENALTY * dot(off, off);
            if (!matches || error >= least) continue;
            least = error;
            place = there;
            layer = nearest;
            slope = held[nearest];
        }
        vec3 contrast = brightest - darkest;
        if (max(contrast.r, max(contrast.g, contrast.b)) > CONTRAST) layer = -1;
        found = layer >= 0 ? w : -w;
        if (layer >= 0) {
            vec2 finer = 0.5 * vec2(unpacked_slopes(uvec4(slope)).x, unpacked_slopes(uvec4(slope >> 8)).x);
            imageStore(sharp_slopes, pixel, uvec4(packed_slope(finer)));
            imageStore(sharp_radiance, pixel, vec4(texelFetch(radiance, ivec3(place, layer), 0).rgb, 1.0));
        } else {
            missing = 1u;
        }
    }
    imageStore(sharp_w, pixel, vec4(found));
}
