// Highlights: texels much brighter than the mean around them, in a window that follows their circle of confusion.

#include "highlights/luminance.glsl"

uniform sampler2D means;        // luminance and number of surfaces of blocks of 8x8 layer pixels, with mipmaps (means.comp)
uniform float floor_share;      // share of the mean of all layers that is added to the mean around a texel

const float BLOCK_PX = 8.0;
const float LEAST_WINDOW_PX = 16.0;

// Least luminance that the surroundings of any texel have.
float least_luminance_around()
{
    vec2 all = textureLod(means, vec2(0.5), 100.0).xy;
    return floor_share * all.x / max(all.y, 1e-6);
}

// Luminance that a texel's surroundings have, with a floor for dark ones; `radius`: circle of confusion, layer pixels.
float luminance_around(ivec2 texel, float radius)
{
    float level = log2((LEAST_WINDOW_PX + 4.0 * radius) / BLOCK_PX);
    vec2 place = (vec2(texel) + 0.5) / (BLOCK_PX * vec2(textureSize(means, 0)));
    vec2 near = textureLod(means, place, level).xy;
    return near.x / max(near.y, 1e-6) + least_luminance_around();
}
