// Luminance of a layer's texel, as much as is seen of it: a surface with negative w is partly transparent.

float luminance(vec3 color)
{
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

float luminance_of(vec4 surface, float w)
{
    return luminance(surface.rgb) * (w > 0.0 ? 1.0 : surface.a);
}
