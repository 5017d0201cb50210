// Splat of a pixel: the radius of its spot, and the share of its light that needs no spot.

uniform sampler2D light;        // premultiplied
uniform sampler2D radii;        // of circles of confusion, in pixels of the light
uniform int channel;            // of the radii
uniform vec3 moments;           // a spot is as wide as an even disc of radius sqrt(x·c² + y·c + z)
uniform bool is_soft;           // whether the lens's errors spread points in focus

// Radius of an even disc that spreads light as far as the spot of a circle of confusion c.
float spot_px(float c)
{
    return sqrt(max((moments.x * c + moments.y) * c + moments.z, 0.0));
}

// Share of a point's light that stays in its pixel.
float sharp_share(float c)
{
    return is_soft ? 0.0 : 1.0 - smoothstep(0.5, 1.0, c);
}
