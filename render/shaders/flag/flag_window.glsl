// Which light of a field is spread by one blur, by its radius.

uniform vec2 rise;      // radii in pixels between which light begins to be this blur's
uniform vec2 fall;      // and ceases to be

float window_share(float radius_px)
{
    return smoothstep(rise.x, rise.y, radius_px) * (1.0 - smoothstep(fall.x, fall.y, radius_px));
}
