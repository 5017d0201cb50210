#version 450 core
// Light that the surfaces of a layer send to the eye, added to what they emit.
// in:  blocks that hold surfaces (shade_blocks.comp); w of the layer, and its surfaces as the colour pass leaves them
//      (surface.frag); lights, dome and shadows (lighting.glsl)
// out: radiance, scene-linear, not premultiplied; opacity stays
// Deferred shading (Saito & Takahashi 1990, "Comprehensible rendering of 3-D shapes"): a rasteriser shades whole blocks of pixels
// for each small triangle.

#include "layers/reflector.glsl"
#include "layers/lighting.glsl"

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) uniform image2DArray radiance;
layout(std430, binding = 0) readonly buffer Blocks { uint count; uint blocks[]; };

uniform sampler2D w_map;
uniform sampler2D albedo_roughness;
uniform sampler2D reflectance_occlusion;
uniform sampler2D normal_coat;
uniform int channel;            // the layer's channel of w
uniform int slice;              // its slice of the radiance
uniform vec3 eye;               // camera space, m
uniform mat2 slope_per_px;      // change of a ray's slope from pixel to pixel: right and up per metre ahead
uniform vec2 first_slope;       // slope at the corner

Reflector reflector_at(ivec2 pixel)
{
    vec4 albedo = texelFetch(albedo_roughness, pixel, 0), f0 = texelFetch(reflectance_occlusion, pixel, 0);
    vec4 normal = texelFetch(normal_coat, pixel, 0);
    return Reflector(albedo.rgb, f0.rgb, albedo.a, f0.a, normal.z, normal.w, direction_of(normal.xy));
}

void main()
{
    uint number = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (number >= count) return;
    ivec2 pixel = 8 * ivec2(blocks[number] & 0xffffu, blocks[number] >> 16) + ivec2(gl_LocalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(w_map, 0)))) return;
    float w = abs(texelFetch(w_map, pixel, 0)[channel]);
    if (w == 0.0) return;
    Reflector surface = reflector_at(pixel);
    vec3 p = vec3((first_slope + slope_per_px * (vec2(pixel) + 0.5)) / w + eye.xy, -1.0 / w);
    vec4 own = imageLoad(radiance, ivec3(pixel, slice));
    vec3 sum = own.rgb + reflected_light(surface, p, normalize(eye - p));
    if (any(isnan(sum)) || any(isinf(sum))) sum = vec3(0.0);  // invalid light counts as none
    imageStore(radiance, ivec3(pixel, slice), vec4(min(sum, vec3(MAX_HALF)), own.a));
}
