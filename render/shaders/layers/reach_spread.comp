#version 450 core
// Inverse depths that rays reach behind a layer, from its gaps: along one line of blocks there and back, rows first, then columns.
// in:  the gaps (reach_gaps.comp), or the result along the rows; the reach behind the layers before (1/m)
// out: the same, spread along the lines; after the columns, the reach behind this layer and those before

layout(local_size_x = 32) in;
layout(r32f, binding = 0) uniform image2D gaps;
#ifdef COLUMNS
layout(r32f, binding = 1) uniform image2D reach;
uniform float room;     // added to the reach, 1/m
#endif

uniform float fall;     // decrease of w from a block to the next, 1/m

void main()
{
    int line = int(gl_GlobalInvocationID.x);
    ivec2 size = imageSize(gaps);
#ifdef COLUMNS
    ivec2 first = ivec2(line, 0), way = ivec2(0, 1);
    int lines = size.x, count = size.y;
#else
    ivec2 first = ivec2(0, line), way = ivec2(1, 0);
    int lines = size.y, count = size.x;
#endif
    if (line >= lines) return;
    float most = NOWHERE;
    for (int i = 0; i < count; ++i) {
        ivec2 at = first + i * way;
        most = max(most - fall, imageLoad(gaps, at).x);
        imageStore(gaps, at, vec4(most));
    }
    most = NOWHERE;
    for (int i = count - 1; i >= 0; --i) {
        ivec2 at = first + i * way;
        most = max(most - fall, imageLoad(gaps, at).x);
#ifdef COLUMNS
        float bound = most + room;
#ifdef BEHIND_OTHERS
        bound = min(bound, imageLoad(reach, at).x);
#endif
        imageStore(reach, at, vec4(bound));
#else
        imageStore(gaps, at, vec4(most));
#endif
    }
}
