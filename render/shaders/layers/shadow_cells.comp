#version 450 core
// One level of the cells of a shadow map: least, greatest and mean reversed depth of 2x2 of the level below.
// in:  the map (FIRST), or the level below
// out: the level

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2DArray coarser;
#ifdef FIRST
layout(binding = 0) uniform sampler2DArray finer;
#else
layout(rgba32f, binding = 1) readonly uniform image2DArray finer;
#endif

uniform int map;

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(place, imageSize(coarser).xy))) return;
    vec3 cell = vec3(1.0, 0.0, 0.0);
    for (int i = 0; i < 4; ++i) {
        ivec3 texel = ivec3(2 * place + ivec2(i & 1, i >> 1), map);
#ifdef FIRST
        vec3 depths = texelFetch(finer, texel, 0).rrr;
#else
        vec3 depths = imageLoad(finer, texel).rgb;
#endif
        cell = vec3(min(cell.x, depths.x), max(cell.y, depths.y), cell.z + 0.25 * depths.z);
    }
    imageStore(coarser, ivec3(place, map), vec4(cell, 0.0));
}
