#version 450 core
// Inverse depths that rays reach behind a layer, from its gaps: along each line of blocks there and back, rows first, then columns.
// in:  the gaps (reach_gaps.comp), or their spread along the rows; with BEHIND_OTHERS the reach behind the layers before (1/m)
// out: the spread along the lines; with COLUMNS, the reach behind this layer and those before
// Blocks side by side may touch: w falls from the second block on, by `fall` for each block less what the way is shortened by.

layout(local_size_x = 32) in;
layout(r32f, binding = 0) readonly uniform image2D from;
layout(r32f, binding = 1) uniform image2D there;    // the spread of the way there
layout(r32f, binding = 2) uniform image2D reach;

uniform float fall;     // decrease of w from a block to the next, 1/m
uniform float room;     // decrease of w that the way is shortened by, 1/m; less than two falls

void main()
{
    int line = int(gl_GlobalInvocationID.x);
    ivec2 size = imageSize(from);
#ifdef COLUMNS
    ivec2 first = ivec2(line, 0), way = ivec2(0, 1);
    int lines = size.x, count = size.y;
#else
    ivec2 first = ivec2(0, line), way = ivec2(1, 0);
    int lines = size.y, count = size.x;
#endif
    if (line >= lines) return;
    float far = NOWHERE, beside = NOWHERE; // spread to this block from those before the last; the last block
    for (int i = 0; i < count; ++i) {
        ivec2 at = first + i * way;
        float own = imageLoad(from, at).x;
        far -= fall;
        imageStore(there, at, vec4(max(max(own, beside), far + room)));
        far = max(far, beside - fall);
        beside = own;
    }
    far = NOWHERE;
    beside = NOWHERE;
    for (int i = count - 1; i >= 0; --i) {
        ivec2 at = first + i * way;
        float own = imageLoad(from, at).x;
        far -= fall;
        float most = max(imageLoad(there, at).x, max(beside, far + room));
        far = max(far, beside - fall);
        beside = own;
#ifdef COLUMNS
#ifdef BEHIND_OTHERS
        most = min(most, imageLoad(reach, at).x);
#endif
        imageStore(reach, at, vec4(most));
#else
        imageStore(there, at, vec4(most));
#endif
    }
}
