// Texels of a layer's radiance: light that leaves the surface (scene-linear), and in alpha
// - of an opaque surface its coverage: 1, or 0 of a holdout;
// - of a partly transparent one its opacity, with a minus sign of a holdout. Its light is not premultiplied.
// A holdout hides what is behind it and has neither light nor coverage.

float opacity_of(vec4 surface, bool opaque)
{
    return opaque ? 1.0 : abs(surface.a);
}

// Premultiplied light and coverage.
vec4 light_of(vec4 surface, bool opaque)
{
    return opaque ? surface : max(surface.a, 0.0) * vec4(surface.rgb, 1.0);
}
