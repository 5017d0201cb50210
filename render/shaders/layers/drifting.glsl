// Motion of this fragment's surface in both halves of the exposure; zero where it stands still.

#include "layers/carried.glsl"

#ifdef MOVES
in vec3 frag_first;
in vec3 frag_second;
#endif

const float STILL_PX = 0.05;    // surfaces that move by less count as still

vec3 own_first()
{
#ifdef MOVES
    return frag_first;
#else
    return vec3(0.0);
#endif
}

vec3 own_second()
{
#ifdef MOVES
    return frag_second;
#else
    return vec3(0.0);
#endif
}

// Whether it moves visibly.
bool drifts()
{
    vec2 first = drift(gl_FragCoord.xy, gl_FragCoord.w, own_first()), second = drift(gl_FragCoord.xy, gl_FragCoord.w, own_second());
    float depth = gl_FragCoord.w * max(abs(own_first().z), abs(own_second().z));
    return max(length(first), length(second)) > STILL_PX || depth > 1e-3;
}
