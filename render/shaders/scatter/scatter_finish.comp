#version 450 core
// Composite the near field over the far field.
// in:  sums of the splats of the near and the far field; both fields before the blur
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
    // a near surface whose radius changes, or that hides another one, covers its pixels by a little less than 1
    float near_coverage = min(front.a, 1.0), coverage = mix(near_coverage, 1.0, smoothstep(0.8, 0.98, near_coverage));
    // surfaces hidden behind an edge are unknown: use the light of what is known, in front of them if need be
    vec3 seen = behind.a > 0.0 ? behind.rgb / behind.a : vec3(0.0);
    if (behind.a <= 0.0) coverage = 1.0;
    // the lens's errors are so large that no light lands here
    if (behind.a <= 0.0 && front.a <= 0.0) {
        vec4 own = texelFetch(light, at, 0);
        front = vec4(own.rgb + (1.0 - own.a) * texelFetch(far, at, 0).rgb, 1.0);
    }
    if (front.a > 0.0) front.rgb *= coverage / front.a;
    imageStore(picture, at, vec4(front.rgb + (1.0 - coverage) * seen, 1.0));
}
