// Light that falls on the film: radiance, exposed and balanced.
// in: light, scene-linear; the exposure's factor; the gains of the white balance

uniform sampler2D light;
uniform float exposure;
uniform vec3 gains;

const float BRIGHTEST = 65504.0;  // the largest half float, as on the CPU

vec3 exposed_at(ivec2 pixel)
{
    vec3 exposed = exposure * texelFetch(light, pixel, 0).rgb;
    return gains * clamp(mix(exposed, vec3(0.0), isnan(exposed)), -BRIGHTEST, BRIGHTEST);
}
