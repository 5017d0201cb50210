#version 450 core
// Radiance of a dome as a rough mirror sees it head-on: the mean over the lobe of GGX, weighted by the cosine (Karis 2013, "Real
// shading in Unreal Engine 4"), from mip levels as large as each sample stands for (Krivanek & Colbert 2008, "Real-time shading with
// filtered importance sampling").
// in:  the dome's image with its mip levels; roughness of the level
// out: one level of a latitude-longitude image

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba16f, binding = 0) writeonly uniform image2D level;

layout(binding = 9) uniform sampler2D dome_map;
uniform float roughness;
uniform int samples;

#include "layers/latlong.glsl"

const float PI = 3.14159265358979;

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(level);
    if (any(greaterThanEqual(texel, size))) return;
    vec2 uv = (vec2(texel) + 0.5) / vec2(size);
    float longitude = (0.5 - uv.x) * 2.0 * PI, polar = uv.y * PI;
    vec3 n = vec3(sin(polar) * sin(longitude), cos(polar), sin(polar) * cos(longitude));
    vec3 x = normalize(cross(abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0), n)), y = cross(n, x);
    float alpha2 = roughness * roughness * roughness * roughness;
    vec2 source = vec2(textureSize(dome_map, 0));
    float last = float(textureQueryLevels(dome_map) - 1), texel_angle = 2.0 * PI * PI / (source.x * source.y);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < samples; ++i) {
        float u = (float(i) + 0.5) / float(samples), turn = 2.0 * PI * fract(float(i) * 0.6180339887);
        float cosine = inversesqrt(1.0 + alpha2 * u / (1.0 - u)), d = cosine * cosine * (alpha2 - 1.0) + 1.0;
        float lit = 2.0 * cosine * cosine - 1.0, sine = 2.0 * cosine * sqrt(max(1.0 - cosine * cosine, 0.0));
        if (lit <= 0.0) continue;
        vec3 l = lit * n + sine * (cos(turn) * x + sin(turn) * y);
        float density = alpha2 / (PI * d * d) * 0.25;
        float around = max(length(l.xz), 0.05);  // texels are narrower near the poles
        float lod = clamp(0.5 * log2(1.0 / (float(samples) * density * texel_angle * around)) + 0.5, 0.0, last);
        sum += vec4(textureLod(dome_map, latlong_uv(l), lod).rgb, 1.0) * lit;
    }
    imageStore(level, texel, vec4(min(sum.rgb / sum.a, vec3(65000.0)), 1.0));
}
