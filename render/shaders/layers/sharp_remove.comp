#version 450 core
// Remove surfaces from the layers that the sharp layer holds.
// in:  w of the sharp layer (1/m; 0 empty, negative where it is still to be shaded); w and slopes of four layers
// out: w, REMOVED where it is in the zone and one of the sharp layer's texels within the texel lies on the same surface

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D layers_w;

uniform sampler2D sharp_w;
uniform usampler2D slopes;
uniform ivec2 offset;           // texel of these layers at the sharp layer's corner
uniform ivec2 first;            // the same in the layers of the whole picture
uniform float half_width;       // largest difference of w from that in focus

#include "trace/slopes.glsl"
#include "layers/sharp_match.glsl"
#include "layers/sharp_focus.glsl"

void main()
{
    ivec2 corner = 2 * ivec2(gl_GlobalInvocationID.xy), pixel = offset + ivec2(gl_GlobalInvocationID.xy);
    // at its border the sharp layer and the layers overlap, since a ray may find a surface from the texel beside
    if (any(lessThan(corner, ivec2(2))) || any(greaterThanEqual(corner + 2, textureSize(sharp_w, 0)))) return;
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, imageSize(layers_w)))) return;
    vec4 stored = imageLoad(layers_w, pixel), kept = stored;
    uvec4 held = texelFetch(slopes, pixel, 0);
    for (int i = 0; i < 4; ++i) {
        ivec2 part = ivec2(i & 1, i >> 1);
        float w = abs(texelFetch(sharp_w, corner + part, 0).r);
        if (w == 0.0) continue;
        kept = mix(kept, vec4(REMOVED), lessThanEqual(prediction_errors(stored, held, 0.5 * vec2(part) - 0.25, w), vec4(ALIKE)));
    }
    float w_f = w_in_focus(vec2(first + pixel - offset) + 0.5);
    imageStore(layers_w, pixel, mix(kept, stored, greaterThan(abs(stored - w_f), vec4(half_width))));
}
