// Distance to which a pixel spreads light, in pixels; below 0 where it has none.

uniform float wide;                 // greatest distance of light, relative to the radius
uniform float beyond_px;            // greatest distance beyond that at which a table has weight

float reach_of(vec4 light, vec2 state)
{
    return light == vec4(0.0) ? -1.0 : state.x > 0.0 ? wide * abs(state.y) + beyond_px : 0.0;
}
