// Share of a field's light that one blur spreads, by its radius.

uniform vec2 rise;      // radii in pixels over which the share rises from 0 to 1
uniform vec2 fall;      // radii in pixels over which it falls to 0

float window_share(float radius_px)
{
    return smoothstep(rise.x, rise.y, radius_px) * (1.0 - smoothstep(fall.x, fall.y, radius_px));
}
