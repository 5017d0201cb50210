// Outline of a blur shape.

uniform sampler2D outline;      // extent up and down over columns from -1 to 1

// Extent of the shape with this radius up and down, `dx` pixels to the right of its middle.
vec2 reach_at(int dx, float radius)
{
    return radius * textureLod(outline, vec2((0.5 + 0.5 * float(dx) / radius) * OUTLINE_INSET + OUTLINE_EDGE, 0.5), 0.0).xy;
}
