#version 450 core
// Takes a field of a picture as it is spread: its light in whole steps, and by which table each pixel of it is.
// in:  light (premultiplied), radii in pixels
// out: `light_now`; `state_now`: number of the table, signed radius in pixels (in front of the focus above 0, behind it below)
// The circle-of-confusion pass of Potmesil & Chakravarty 1981, at the steps of Fearing 1995, section 4.2.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) uniform writeonly image2D light_now;
layout(rg32f, binding = 1) uniform writeonly image2D state_now;

uniform sampler2D light;
uniform sampler2D radii;
uniform int channel;                // of the radii
uniform float side;                 // 1 in front of the focus, -1 behind it; where the radii are signed, 1
uniform float step_px;
uniform float even_steps;
uniform float most_step;
uniform float quantum;              // of light: a power of 2
uniform float quantum_alpha;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(at, imageSize(light_now)))) return;
    vec4 from = texelFetch(light, at, 0);
    from = mix(clamp(from, -1e12, 1e12), vec4(0.0), isnan(from));   // what is no number would stay in every sum for ever
    float radius = texelFetch(radii, at, 0)[channel];
    float x = abs(radius) / step_px;
    float steps = min(floor((x <= even_steps ? x : even_steps * (1.0 + log(x / even_steps))) + 0.5), most_step);
    float rounded = step_px * (steps <= even_steps ? steps : even_steps * exp(steps / even_steps - 1.0));
    vec4 grid = vec4(vec3(quantum), quantum_alpha);
    imageStore(light_now, at, roundEven(from / grid) * grid);
    imageStore(state_now, at, vec4(steps, sign(radius) * side * rounded, 0.0, 0.0));
}
