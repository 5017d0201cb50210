#version 450 core
// Mark the tiles that changes reach, and the tiles in which a pixel's own state changes.
// in:  `emitters`, `reaches` of half tiles (linear_load.comp); PICKED: pixels that are spread now
// out: `reached`: 1 for each tile that light reaches; `rechecked`: 1 for each tile in which a pixel's own state changes

layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Emitters { uvec4 emitters[]; };
layout(std430, binding = 2) readonly buffer Reaches { float reaches[]; };
layout(std430, binding = 3) writeonly buffer Reached { uint reached[]; };
layout(std430, binding = 4) writeonly buffer Rechecked { uint rechecked[]; };
#ifdef PICKED
layout(std430, binding = 5) readonly buffer Picked { uint picked[]; };
#endif

uniform sampler2D state_now;
uniform sampler2D state_last;
uniform ivec2 tiles;
uniform bool has_cutoff;

void main()
{
    int lane = int(gl_GlobalInvocationID.x);
    ivec2 tile = ivec2((lane >> 1) % tiles.x, (lane >> 1) / tiles.x);
    if (tile.y >= tiles.y) return;
    uint bits = emitters[lane].x;
#ifdef PICKED
    bits &= picked[lane];
#endif
    float reach = bits == 0u ? -1.0 : reaches[lane];
    int count = has_cutoff ? bitCount(bits) : 0;
    bool is_rechecked = false;
    for (int i = 0; i < count; ++i) {
        int bit = findLSB(bits);
        bits &= bits - 1u;
        ivec2 at = tile * 8 + ivec2(bit & 7, (lane & 1) * 4 + (bit >> 3));
        if (texelFetch(state_now, at, 0).y != texelFetch(state_last, at, 0).y) is_rechecked = true;
    }
    if (is_rechecked) rechecked[lane >> 1] = 1u;
    int around = reach < 0.0 ? -1 : (int(reach) + 7) / 8;
    ivec2 low = max(tile - around, ivec2(0)), high = min(tile + around, tiles - 1);
    for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x)
            if (length(vec2(max(abs(ivec2(x, y) - tile) * 8 - 7, 0))) <= reach) reached[y * tiles.x + x] = 1u;
}
