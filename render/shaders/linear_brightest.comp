#version 450 core
// The brightest light of a field: the scale that its sums are made in.
// out: `brightest`: the bits of a float, of what is 0 or more as ordered as the numbers are

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) buffer Brightest { uint brightest; };

uniform sampler2D light;

shared uint most;

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (gl_LocalInvocationIndex == 0u) most = 0u;
    barrier();
    if (all(lessThan(at, textureSize(light, 0)))) {
        vec3 here = abs(texelFetch(light, at, 0).rgb);
        float peak = max(here.r, max(here.g, here.b));
        if (!isnan(peak)) atomicMax(most, floatBitsToUint(min(peak, 1e12)));
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) atomicMax(brightest, most);
}
