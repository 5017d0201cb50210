#version 450 core
// Light of a splat on a pixel; additive blending sums the splats.

flat in vec4 point_light;
flat in ivec2 corner;
flat in int table;
flat in float next;

uniform sampler2DArray weights;

layout(location = 0) out vec4 light_here;

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy) - corner;
    float here = texelFetch(weights, ivec3(at, table), 0).r, wider = texelFetch(weights, ivec3(at, table + 1), 0).r;
    light_here = point_light * mix(here, wider, next);
}
