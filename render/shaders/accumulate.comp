#version 450 core
// Adds one pinhole view, its transparent layers composited, to an accumulation image.
// in:  the layers' w (1/m; 0 empty, negative partly transparent), radiance and background; the view's weight
// out: radiance premultiplied by coverage (with the background behind) and coverage in `sum`, added
// Haeberli & Akeley 1990.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;

uniform sampler2D packed_w;
uniform sampler2DArray radiance;
uniform sampler2D background;
uniform int count;
uniform float weight;

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(sum)))) return;
    vec4 w = texelFetch(packed_w, pixel, 0);
    vec4 seen = vec4(0.0);
    for (int i = 0; i < count && w[i] != 0.0 && seen.a < 1.0; ++i) {
        vec4 surface = texelFetch(radiance, ivec3(pixel, i), 0);
        seen += (1.0 - seen.a) * (w[i] > 0.0 ? 1.0 : surface.a) * vec4(surface.rgb, 1.0);
    }
    seen.rgb += (1.0 - seen.a) * texelFetch(background, pixel, 0).rgb;
    imageStore(sum, pixel, imageLoad(sum, pixel) + weight * seen);
}
