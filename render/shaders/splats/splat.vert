#version 450 core
// Corners of the parallelogram around a splat's ellipse; one instance for each splat.
// in:  records of splats (render/layers/splats.py), far to near
// out: place in standard deviations of the splat; its colour and opacity, and w (1/m); where NUMBERED is defined, how many splats
//      of the list are nearer

layout(std430, binding = 0) readonly buffer Splats { vec4 splats[]; };

uniform int first;          // splat of the first instance
uniform vec2 corner_px;     // pixel of the splats' view at the target's corner
uniform float texel_scale;  // texels of the target per pixel of that view
uniform vec2 target_px;     // size of the target

#ifdef NUMBERED
uniform int begin;          // row of the buffer's first splat
uniform int last_row;       // of the nearest splat

flat out float nearer;
#endif
out vec2 spread;
flat out vec4 light;
#ifdef OWNERS
flat out int owner;         // number of the splat's cloud
#endif
flat out float w;

void main()
{
    int i = 3 * (first + gl_InstanceID);
    vec4 place = splats[i], shape = splats[i + 1];
    light = vec4(splats[i + 2].rgb, place.w);
    w = place.z;
#ifdef OWNERS
    owner = int(splats[i + 2].w);
#endif
#ifdef NUMBERED
    nearer = float(last_row - begin - first - gl_InstanceID);
#endif
    spread = shape.w * (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0);
    vec2 at = place.xy + vec2(shape.x * spread.x, shape.y * spread.x + shape.z * spread.y);
    gl_Position = vec4(2.0 * texel_scale * (at - corner_px) / target_px - 1.0, 0.0, 1.0);
}
