#version 450 core
// Light of a splat, to be blended over what lies behind it: in one plane of several (trace/splat_planes.glsl), or, where BETWEEN is
// defined, between two layers of a pinhole's picture (accumulate.comp).
// in:  splat.vert's outputs; w of the layers of the pixel (1/m; 0 empty, negative partly transparent)
// out: premultiplied radiance and opacity; where OWNERS is defined, in place of the radiance, the shares of three clouds in the opacity
// Kerbl et al. 2023, section 4.

in vec2 spread;
flat in vec4 light;
flat in float w;
#ifdef OWNERS
flat in int owner;
uniform int first_owner;        // of the three clouds
#endif

layout(location = 0) out vec4 out_light;

uniform sampler2D packed_w;
#ifdef BETWEEN
uniform sampler2D before_w;     // of the layer in front
uniform int channel;            // of the layer behind in packed_w; -1 for no layer
uniform int before_channel;     // likewise
#else
uniform float texel_scale;      // as in splat.vert
uniform vec2 corner_px;         // likewise
uniform vec2 layers_px;         // first pixel of the layers
uniform vec2 bin;               // least and greatest w of the plane's splats
#endif

const float LEAST_OPACITY = 1.0 / 255.0;

// Whether a surface hides the splat, or it is to be drawn elsewhere.
bool is_left_out()
{
#ifdef BETWEEN
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float low = channel < 0 ? -1e30 : abs(texelFetch(packed_w, pixel, 0)[channel]);
    float high = before_channel < 0 ? 1e30 : abs(texelFetch(before_w, pixel, 0)[before_channel]);
    return w <= low || w > high;
#else
    ivec2 pixel = ivec2(floor(gl_FragCoord.xy / texel_scale + corner_px - layers_px));
    pixel = clamp(pixel, ivec2(0), textureSize(packed_w, 0) - 1);
    vec4 stored = texelFetch(packed_w, pixel, 0);
    float wall = stored.x > 0.0 ? stored.x : stored.y > 0.0 ? stored.y : stored.z > 0.0 ? stored.z : stored.w;
    return w < wall && wall >= bin.x && wall <= bin.y;
#endif
}

void main()
{
    float opacity = light.a * exp(-0.5 * dot(spread, spread));
    if (opacity < LEAST_OPACITY || is_left_out()) discard;
#ifdef OWNERS
    out_light = opacity * vec4(vec3(equal(ivec3(owner - first_owner), ivec3(0, 1, 2))), 1.0);
#else
    out_light = opacity * vec4(min(light.rgb, vec3(65000.0)), 1.0);
#endif
}
