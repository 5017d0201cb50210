// Surfaces as the colour pass leaves them (surface.frag).

#include "layers/reflector.glsl"

uniform sampler2D albedo_roughness;  // roughness below 0 of a surface whose opacity fades its diffuse response alone
uniform sampler2D reflectance_occlusion;
uniform sampler2D normal_coat;

Reflector reflector_at(ivec2 pixel)
{
    vec4 albedo = texelFetch(albedo_roughness, pixel, 0), f0 = texelFetch(reflectance_occlusion, pixel, 0);
    vec4 normal = texelFetch(normal_coat, pixel, 0);
#ifdef LINKED
    normal.z = float(uint(normal.z * 65535.0 + 0.5) & 255u) / 255.0;
#endif
    return Reflector(albedo.rgb, f0.rgb, abs(albedo.a), f0.a, normal.z, normal.w, direction_of(normal.xy));
}

#ifdef LINKED
// Number of the set of lights that leave the surface out; shares its channel with the clear coat.
uint link_set_at(ivec2 pixel)
{
    return uint(texelFetch(normal_coat, pixel, 0).z * 65535.0 + 0.5) >> 8;
}
#endif
