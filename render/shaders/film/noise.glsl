// Normal numbers of mean 0 and variance 1 for each pixel, as in render/film/noise.py.
// PCG in four dimensions (Jarzynski & Olano 2020, JCGT 9:3), made normal by Box & Muller (1958).

uniform uvec2 noise_key;

void mix_words(inout uvec4 v)
{
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
}

// Number in the open interval (0, 1); exact in single precision.
vec2 uniform_of(uvec2 words)
{
    return (vec2(words >> 9u) + 0.5) * exp2(-23.0);
}

vec4 normal_noise(ivec2 place)
{
    uvec4 v = uvec4(uvec2(place), noise_key) * 1664525u + 1013904223u;
    mix_words(v);
    v ^= v >> 16u;
    mix_words(v);
    vec2 radius = sqrt(-2.0 * log(uniform_of(v.xz)));
    vec2 angle = 6.28318530718 * (uniform_of(v.yw) - 0.5);
    return vec4(radius.x * cos(angle.x), radius.x * sin(angle.x), radius.y * cos(angle.y), radius.y * sin(angle.y));
}
