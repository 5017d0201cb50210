// Importance of a change, and the bucket that it puts the pixel in (Fearing 1995, section 4.3).
// out: `waiting`: bucket, 0 for no change, and 256 times the number of pictures that the pixel has waited for; `counts` of the buckets,
//      in each chunk of 64 half tiles
// Buckets are quarters of an octave of importance. A waiting change doubles in importance with each picture, so that none starves.

layout(r32ui, binding = 2) uniform uimage2D waiting;
layout(std430, binding = 6) writeonly buffer Counts { uint counts[]; };

uniform float coc_weight;       // weight of a pixel of radius
uniform float rgb_weight;       // weight of a unit of light, or of perceptual distance
uniform bool is_perceptual;
uniform uint chunks;

shared uint found[64];

// Oklab (Ottosson 2020) of linear Rec. 709.
vec3 perceived(vec3 rgb)
{
    const mat3 to_cones = mat3(0.4122214708, 0.2119034982, 0.0883024619, 0.5363325363, 0.6806995451, 0.2817188376,
                               0.0514459929, 0.1073969566, 0.6299787005);
    const mat3 to_lab = mat3(0.2104542553, 1.9779984951, 0.0259040371, 0.7936177850, -2.4285922050, 0.7827717662,
                             -0.0040720468, 0.4505937099, -0.8086757660);
    return to_lab * pow(max(to_cones * max(rgb, 0.0), 0.0), vec3(1.0 / 3.0));
}

void begin_counting()
{
    found[gl_LocalInvocationID.x] = 0u;
    barrier();
}

void count_change(ivec2 at, bool has_changed, vec4 now, vec2 state, vec4 last, vec2 state_before)
{
    float colour = is_perceptual ? distance(vec4(perceived(now.rgb), now.a), vec4(perceived(last.rgb), last.a)) : distance(now, last);
    float h = coc_weight * abs(state.y - state_before.y) + rgb_weight * colour;
    uint before = imageLoad(waiting, at).r;
    uint age = !has_changed || (before & 255u) == 0u ? 0u : min((before >> 8) + 1u, 64u);
    uint bucket = !has_changed ? 0u : uint(clamp(4.0 * (log2(max(h, 1e-9)) + 12.0 + float(age)) + 1.0, 1.0, 63.0));
    imageStore(waiting, at, uvec4(bucket | (age << 8)));
    if (bucket > 0u) atomicAdd(found[bucket], 1u);
}

void end_counting()
{
    barrier();
    counts[gl_LocalInvocationID.x * chunks + gl_WorkGroupID.x] = found[gl_LocalInvocationID.x];
}
