#version 450 core
// One level of a mipmap from the level before: means over rectangles, weighted by area where a side is odd.
// in:  finer
// out: coarser
// variants: ONE_CHANNEL for one channel in place of two

#ifdef ONE_CHANNEL
#define LEVEL_FORMAT r32f
#else
#define LEVEL_FORMAT rg32f
#endif

layout(local_size_x = 8, local_size_y = 8) in;
layout(LEVEL_FORMAT, binding = 0) uniform readonly image2D finer;
layout(LEVEL_FORMAT, binding = 1) uniform writeonly image2D coarser;

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy), size = imageSize(coarser), finer_size = imageSize(finer);
    if (any(greaterThanEqual(place, size))) return;
    vec2 scale = vec2(finer_size) / vec2(size);
    vec2 low = vec2(place) * scale, high = low + scale;
    ivec2 first = ivec2(low), end = min(ivec2(ceil(high)), finer_size);
    vec2 sum = vec2(0.0);
    for (int y = first.y; y < end.y; ++y) {
        for (int x = first.x; x < end.x; ++x) {
            vec2 overlap = max(min(high, vec2(x, y) + 1.0) - max(low, vec2(x, y)), 0.0);
            sum += overlap.x * overlap.y * imageLoad(finer, ivec2(x, y)).xy;
        }
    }
    imageStore(coarser, place, vec4(sum / (scale.x * scale.y), 0.0, 0.0));
}
