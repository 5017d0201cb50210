#version 450 core
// One stage of a Fourier transform along one axis: Stockham's self-sorting transform of mixed radix (Govindaraju et al. 2008).
// in:  two complex numbers for each place, row by row; RADIX, and its ROOTS of unity; AXIS
// out: the same; after all stages of an axis, whose radices multiply to its length, the transform, unnormalized

layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Source { vec4 source[]; };
layout(std430, binding = 1) writeonly buffer Target { vec4 target[]; };
#ifdef SPECTRUM
layout(std430, binding = 2) readonly buffer Spectrum { float spectrum[]; };  // factor on the input
#endif

uniform ivec2 size;
uniform int done;          // product of the radices of the stages before
uniform float direction;   // -1 forward, 1 inverse

const vec2 root[RADIX] = vec2[](ROOTS);

vec4 times(vec4 pair, vec2 factor)
{
    return vec4(pair.x * factor.x - pair.y * factor.y, pair.x * factor.y + pair.y * factor.x,
                pair.z * factor.x - pair.w * factor.y, pair.z * factor.y + pair.w * factor.x);
}

void main()
{
    ivec2 id = ivec2(gl_GlobalInvocationID.xy);
    int part = size[AXIS] / RADIX;
    int line = id[1 - AXIS], j = id[AXIS];
    if (j >= part || line >= size[1 - AXIS]) return;
    int stride = AXIS == 0 ? 1 : size.x;
    int first = line * (AXIS == 0 ? size.x : 1);

    int place = j % done;
    vec4 value[RADIX];
    for (int r = 0; r < RADIX; ++r) {
        int from = first + stride * (j + r * part);
        float turn = float(r * place) / float(done * RADIX);
        float angle = direction * 6.28318530718 * (turn - round(turn));
        value[r] = times(source[from], vec2(cos(angle), sin(angle)));
#ifdef SPECTRUM
        value[r] *= spectrum[from];
#endif
    }
    int to = (j - place) * RADIX + place;
    for (int k = 0; k < RADIX; ++k) {
        vec4 sum = value[0];
        for (int r = 1; r < RADIX; ++r) {
            vec2 turn = root[(r * k) % RADIX];
            sum += times(value[r], vec2(turn.x, direction * turn.y));
        }
        target[first + stride * (to + k * done)] = sum;
    }
}
