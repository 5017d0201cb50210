#version 450 core
// List the splats that scatter/scatter_plan.comp has planned, by class and in the order of the picture, so that sums
// are reproducible.
// in:  the plan; `offsets` in the list of the first splat of each class and work group
// out: `spots`: 15 bits each for column and row, and log2 of the side

layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 1) writeonly buffer Spots { uint spots[]; };

uniform usampler2D plan;

shared uint drawn[2 * CLASSES];

void main()
{
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    int lane = int(gl_LocalInvocationIndex);
    if (lane < 2 * CLASSES) drawn[lane] = 0u;
    barrier();
    int planned = all(lessThan(at, textureSize(plan, 0))) ? int(texelFetch(plan, at, 0).r) - 1 : -1;
    int kind = planned < 0 ? 0 : planned % CLASSES, word = lane >> 5;
    uint bit = 1u << (lane & 31);
    if (planned >= 0) atomicOr(drawn[2 * kind + word], bit);
    barrier();
    if (planned < 0) return;
    int groups = int(gl_NumWorkGroups.x * gl_NumWorkGroups.y);
    int group = int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    int before = bitCount(drawn[2 * kind + word] & (bit - 1u));
    if (word == 1) before += bitCount(drawn[2 * kind]);
    spots[offsets[kind * groups + group] + uint(before)] = uint(at.x) | uint(at.y) << 15 | uint(planned / CLASSES) << 30;
}
