#version 450 core
// Composite a size class of splats behind the classes in front of it.
// in:  light and coverage of one class
// out: `sum`: the classes so far, from the front; a fully covered pixel takes no more
// Nearer size classes are composited over farther ones, so that a strongly blurred background does not leak over a less
// blurred one; a surface that spans two classes fills its pixels from both.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform image2D sum;

uniform sampler2D class_light;
uniform vec2 class_px;          // size of the class in pixels of the picture

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(sum)))) return;
    vec4 before = imageLoad(sum, at), more = textureLod(class_light, (vec2(at) + 0.5) / class_px, 0.0);
    if (more.a <= 0.0) return;
    imageStore(sum, at, before + more * min(max(1.0 - before.a, 0.0) / more.a, 1.0));
}
