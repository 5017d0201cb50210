// Effects of a pixel's change: lights to add to the sums, each spread by one table.
// state: number of the table, signed radius in pixels

uniform bool has_cutoff;            // whether nearer pixels hide farther ones; two states then never share an effect

// Unchanged light that is spread by the next table: one effect, by the difference of the two tables.
bool is_step(vec4 light, vec2 state, vec4 light_before, vec2 state_before)
{
    return !has_cutoff && light == light_before && abs(state.x - state_before.x) == 1.0 && state.y * state_before.y >= 0.0;
}

// Whether the old effect must be subtracted by itself: not where new and old light are spread by the same table.
bool is_twofold(vec4 light, vec2 state, vec4 light_before, vec2 state_before)
{
    return state != state_before && light_before != vec4(0.0) && !is_step(light, state, light_before, state_before);
}
