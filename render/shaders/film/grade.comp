#version 450 core
// Expose light and convert it to a display's picture.
// in:  light, linear; the exposure's factor; OpenColorIO's code and tables, which define `vec4 displayed(vec4 light)`, with CDL from
//      the space where the CDL works, and `vec4 timed(vec4 light)` into that space; the CDL
// out: the picture, encoded for the display, 0 to 1; its format is the bound image's

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0) writeonly uniform image2D picture;

uniform sampler2D light;
uniform float exposure;

#ifdef CDL
uniform vec3 slope;
uniform vec3 offset;
uniform vec3 power;
uniform float saturation;
#endif

const float BRIGHTEST = 65504.0;  // the largest half float, as on the CPU

#pragma transform

#ifdef CDL
// ASC CDL 1.2 without its clamps, as in OpenColorIO: values below 0 are not raised to the power.
vec3 decided(vec3 rgb)
{
    vec3 scaled = slope * rgb + offset;
    vec3 raised = mix(scaled, pow(max(scaled, vec3(0.0)), power), greaterThan(scaled, vec3(0.0)));
    float luma = dot(raised, vec3(0.2126, 0.7152, 0.0722));
    return luma + saturation * (raised - luma);
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(picture)))) return;
    vec3 exposed = exposure * texelFetch(light, pixel, 0).rgb;
    exposed = clamp(mix(exposed, vec3(0.0), isnan(exposed)), -BRIGHTEST, BRIGHTEST);
#ifdef CDL
    exposed = decided(timed(vec4(exposed, 1.0)).rgb);
#endif
    vec3 shown = displayed(vec4(exposed, 1.0)).rgb;
    imageStore(picture, pixel, vec4(clamp(mix(shown, vec3(0.0), isnan(shown)), 0.0, 1.0), 1.0));
}
