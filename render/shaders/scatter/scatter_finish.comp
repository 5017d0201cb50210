#version 450 core
// The picture: what is in front of the focus, over what is in it or behind.
// in:  sums of what is spread before and behind the focus; both fields sharp
// out: `picture`: radiance premultiplied by coverage, coverage

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D picture;

#include "scatter/scatter.glsl"

uniform sampler2D far;
uniform sampler2D near_sum;
uniform sampler2D far_sum;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(picture)))) return;
    vec4 front = texelFetch(near_sum, at, 0), behind = texelFetch(far_sum, at, 0);
    vec4 sharp = texelFetch(light, at, 0) * sharp_share(texelFetch(radii, at, 0)[channel]);
    if (sharp.a > 0.0) front += sharp * min(max(1.0 - front.a, 0.0) / sharp.a, 1.0);
    // a surface before the focus whose radius changes, or that hides another one, falls a little short of filling its pixels
    float cover = min(front.a, 1.0), filled = mix(cover, 1.0, smoothstep(0.8, 0.98, cover));
    // what is hidden and would be seen around an edge is unknown: the light is that of what is known, before it if need be
    vec3 seen = behind.a > 0.0 ? behind.rgb / behind.a : vec3(0.0);
    if (behind.a <= 0.0) filled = 1.0;
    // a lens so bad that no light lands here at all
    if (behind.a <= 0.0 && front.a <= 0.0) {
        vec4 own = texelFetch(light, at, 0);
        front = vec4(own.rgb + (1.0 - own.a) * texelFetch(far, at, 0).rgb, 1.0);
    }
    if (front.a > 0.0) front.rgb *= filled / front.a;
    imageStore(picture, at, vec4(front.rgb + (1.0 - filled) * seen, 1.0));
}
