// What is blurred at less resolution.

uniform float split_px;     // radius from which on light is spread at less resolution; 0 where all of it keeps its own

// Share of the light with this radius that is spread at less resolution.
float wide_share(float radius_px)
{
    return split_px > 0.0 ? smoothstep(0.5 * split_px, split_px, radius_px) : 0.0;
}
