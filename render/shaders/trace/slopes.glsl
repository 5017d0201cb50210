// Slope of a surface's inverse depth over a layer pixel, relative to w, in 16 bits: eight along x and eight along y,
// finer where the slope is small. w is linear over a plane's picture, so w and its slope define the plane.

const float STEEPEST = 1.0;       // relative change of w per pixel; steeper surfaces are seen edge-on
const float LONGEST_REACH = 0.05; // greatest relative change of w by which a surface is extended from a pixel's centre to its corner
const int REACH_BLOCK = 2;         // side of the blocks of reach_spread.comp, px
const float UNLIKE = 0.003;       // relative difference of w between pixels of one surface, beyond their slopes

uint packed_slope(vec2 slope)
{
    vec2 root = sign(slope) * pow(min(abs(slope) / STEEPEST, 1.0), vec2(1.0 / 3.0));
    uvec2 bits = uvec2(ivec2(round(127.0 * root)) + 128);
    return bits.x | bits.y << 8;
}

vec4 unpacked_slopes(uvec4 bits)
{
    vec4 root = (vec4(bits & 255u) - 128.0) / 127.0;
    return STEEPEST * root * root * root;
}

// Greatest relative difference of w between a pixel's centre and its corners, for four surfaces.
vec4 reach_of(uvec4 slopes)
{
    return min(0.5 * (abs(unpacked_slopes(slopes)) + abs(unpacked_slopes(slopes >> 8))), vec4(LONGEST_REACH));
}
