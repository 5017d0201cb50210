#version 450 core
// Composite the blurred parts of a picture: near over far, and the slightly blurred far part over the strongly blurred one.
// in:  blurred parts (light and coverage), and their wide blurs at less resolution; the far field before the blur, and
//      its radii. With MIDDLE, the slightly blurred far field is a part of its own
// out: `picture`: radiance premultiplied by coverage, coverage

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D picture;

uniform sampler2D near;
uniform sampler2D far;
uniform sampler2D near_wide;
uniform sampler2D far_wide;
uniform vec2 near_wide_px;      // pixels of the picture that they cover; 0 where there is none
uniform vec2 far_wide_px;
#ifdef MIDDLE
uniform sampler2D middle;
uniform sampler2D middle_wide;
uniform vec2 middle_wide_px;
#endif
uniform sampler2D far_sharp;
uniform sampler2D radii;

vec4 part(ivec2 at, sampler2D fine, sampler2D wide, vec2 wide_px)
{
    vec4 light = texelFetch(fine, at, 0);
    return wide_px.x > 0.0 ? light + textureLod(wide, (vec2(at) + 0.5) / wide_px, 0.0) : light;
}

// Composite one part over another. Coverage above 1 counts as 1.
vec3 over(vec4 before, vec3 behind)
{
    return before.a >= 1.0 ? before.rgb / before.a : before.rgb + (1.0 - before.a) * behind;
}

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(picture)))) return;
    vec4 behind = part(at, far, far_wide, far_wide_px);
#ifdef MIDDLE
    vec4 between = part(at, middle, middle_wide, middle_wide_px);
#else
    vec4 between = vec4(0.0);
#endif
    vec4 before = part(at, near, near_wide, near_wide_px);
    vec4 sharp = texelFetch(far_sharp, at, 0);
    // surfaces hidden behind an edge are unknown: use the light of what is known, in front of them if need be
    vec3 light = sharp.rgb;
    if (behind.a > 0.0) light = over(between, behind.rgb / behind.a);
    else if (between.a > 0.0) light = between.rgb / between.a;
    else if (before.a > 0.0) light = before.rgb / before.a;
    // the blur of a farther surface does not reach over a surface in focus
    if (sharp.a > 0.0) light = mix(sharp.rgb, light, smoothstep(0.5, 1.5, texelFetch(radii, at, 0).g));
    imageStore(picture, at, vec4(over(before, light), 1.0));
}
