#version 450 core
// Joins what is blurred in front of the focus with what is blurred behind it.
// in:  both fields blurred (light and how much there is of it), and what of them is blurred at less resolution; the far field sharp, and
//      its radii
// out: `picture`: radiance premultiplied by coverage, coverage

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D picture;

uniform sampler2D near;
uniform sampler2D far;
uniform sampler2D near_wide;
uniform sampler2D far_wide;
uniform bool is_split;
uniform vec2 wide_px;           // pixels of the picture that those cover
uniform sampler2D far_sharp;
uniform sampler2D radii;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(picture)))) return;
    vec4 behind = texelFetch(far, at, 0), front = texelFetch(near, at, 0);
    if (is_split) {
        vec2 place = (vec2(at) + 0.5) / wide_px;
        behind += textureLod(far_wide, place, 0.0);
        front += textureLod(near_wide, place, 0.0);
    }
    vec3 sharp = texelFetch(far_sharp, at, 0).rgb;
    // what is hidden and would be seen around an edge is unknown: the light is that of what is known, before it if need be
    vec3 light = behind.a > 0.0 ? behind.rgb / behind.a : front.a > 0.0 ? front.rgb / front.a : sharp;
    // and the blur of what lies behind it does not reach over what is in focus
    light = mix(sharp, light, smoothstep(0.5, 1.5, texelFetch(radii, at, 0).g));
    float cover = min(front.a, 1.0);
    vec3 before = front.a > 1.0 ? front.rgb / front.a : front.rgb;
    imageStore(picture, at, vec4(before + (1.0 - cover) * light, 1.0));
}
