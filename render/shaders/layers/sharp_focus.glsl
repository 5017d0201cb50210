// Inverse depth in focus at a texel of the layers, from a grid over the layers of the whole picture, corners included.

uniform sampler2D focus_grid;   // w in 1/m
uniform vec2 whole;             // size of the whole picture's layers

float w_in_focus(vec2 place)
{
    ivec2 last = textureSize(focus_grid, 0) - 1;
    vec2 at = clamp(place / whole, 0.0, 1.0) * vec2(last);
    ivec2 cell = min(ivec2(at), last - 1);
    vec2 within = at - vec2(cell);
    vec4 w = vec4(texelFetch(focus_grid, cell, 0).r, texelFetch(focus_grid, cell + ivec2(1, 0), 0).r,
                  texelFetch(focus_grid, cell + ivec2(0, 1), 0).r, texelFetch(focus_grid, cell + 1, 0).r);
    vec2 across = mix(w.xz, w.yw, within.x);
    return mix(across.x, across.y, within.y);
}
