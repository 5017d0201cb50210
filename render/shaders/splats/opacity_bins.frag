#version 450 core
// How much each of sixteen runs of a pixel's splats hides, to be added up: -log of the light that they let pass.
// in:  splat.vert's outputs, NUMBERED; what is known of each pixel
// out: sixteen runs from the pixel's first splat on, four in each target

in vec2 spread;
flat in vec4 light;
flat in float nearer;

layout(location = 0) out vec4 runs_0;
layout(location = 1) out vec4 runs_1;
layout(location = 2) out vec4 runs_2;
layout(location = 3) out vec4 runs_3;

uniform sampler2D known;    // number of the splat that the first run begins with, and what those in front of it hide; -1 for none
uniform float run_length;   // splats of a run

const float LEAST_OPACITY = 1.0 / 255.0;

void main()
{
    float opacity = light.a * exp(-0.5 * dot(spread, spread));
    float begin = texelFetch(known, ivec2(gl_FragCoord.xy), 0).x;
    if (opacity < LEAST_OPACITY || begin < 0.0 || nearer < begin || nearer >= begin + 16.0 * run_length) discard;
    int run = int((nearer - begin) / run_length);
    vec4 hides = vec4(equal(ivec4(run & 3), ivec4(0, 1, 2, 3))) * -log(1.0 - opacity);
    ivec4 targets = ivec4(equal(ivec4(run >> 2), ivec4(0, 1, 2, 3)));
    runs_0 = float(targets.x) * hides;
    runs_1 = float(targets.y) * hides;
    runs_2 = float(targets.z) * hides;
    runs_3 = float(targets.w) * hides;
}
