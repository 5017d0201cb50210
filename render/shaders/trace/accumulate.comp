#version 450 core
// Composite one pinhole view front to back, four layers at a time, and add it to an accumulation image.
// in:  the layers' w (1/m; 0 empty, negative partly transparent), radiance and background; the picture of the layers in
//      front of them in `seen`, and the share of light that those let pass in `through`; the view's weight
// out: with the last layers, radiance premultiplied by coverage (with the background behind) and coverage, added to `sum`;
//      before that, the picture so far in `seen` and `through`
// Haeberli & Akeley 1990.

#include "layers/coverage.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;
layout(rgba32f, binding = 1) uniform image2D seen;
layout(r32f, binding = 2) uniform image2D through;

uniform sampler2D packed_w;
uniform sampler2DArray radiance;
uniform sampler2D background;
uniform int slice_of_first;  // slice of `radiance` of the first layer
uniform int count;
uniform bool is_first;
uniform bool is_last;
uniform float weight;
#ifdef SPLATS
uniform sampler2DArray between;     // premultiplied light and opacity of the splats in front of each layer, and behind the last
const int MOST_BETWEEN = 5;         // slices of it, behind which there are as many for the opacity of holdouts
#endif

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(sum)))) return;
    vec4 w = texelFetch(packed_w, pixel, 0);
    vec4 total = is_first ? vec4(0.0) : imageLoad(seen, pixel);
    float passing = is_first ? 1.0 : imageLoad(through, pixel).r;
#ifdef SPLATS
    for (int i = 0; i <= count && (i < count || is_last); ++i) {
        vec4 splats = texelFetch(between, ivec3(pixel, i), 0);
        total += passing * splats;
#ifdef HELD_SPLATS
        total.a -= passing * texelFetch(between, ivec3(pixel, i + MOST_BETWEEN), 0).r;
#endif
        passing *= 1.0 - splats.a;
        float w_here = i < count ? w[i] : 0.0;
        if (w_here == 0.0) break;
        vec4 surface = texelFetch(radiance, ivec3(pixel, slice_of_first + i), 0);
        total += passing * light_of(surface, w_here > 0.0);
        passing *= 1.0 - opacity_of(surface, w_here > 0.0);
    }
#else
    for (int i = 0; i < count; ++i) {
        float w_of_layer = w[i];  // as part of the loop's condition, NVIDIA's compiler 580 leaves the test out
        if (w_of_layer == 0.0 || passing <= 0.0) break;
        vec4 surface = texelFetch(radiance, ivec3(pixel, slice_of_first + i), 0);
        total += passing * light_of(surface, w_of_layer > 0.0);
        passing *= 1.0 - opacity_of(surface, w_of_layer > 0.0);
    }
#endif
    if (is_last) {
        total.rgb += passing * texelFetch(background, pixel, 0).rgb;
        imageStore(sum, pixel, imageLoad(sum, pixel) + weight * total);
    } else {
        imageStore(seen, pixel, total);
        imageStore(through, pixel, vec4(passing));
    }
}
