// Outline of a blur shape.

uniform sampler2D outline;      // extent up and down, over columns from the left to the right end
uniform vec2 span;              // left and right end of the shape with radius 1
uniform float unit_area;        // its area

// Whether the shape with this radius has a column `dx` pixels to the right of its middle.
bool has_column(int dx, float radius)
{
    return dx == 0 || float(dx) > radius * span.x && float(dx) < radius * span.y;
}

// Extent of the shape with this radius up and down, `dx` pixels to the right of its middle. One is below 0 where the column does
// not cross the middle line.
vec2 reach_at(float dx, float radius)
{
    float place = (dx / radius - span.x) / (span.y - span.x);
    return radius * textureLod(outline, vec2(place * OUTLINE_INSET + OUTLINE_EDGE, 0.5), 0.0).xy;
}
