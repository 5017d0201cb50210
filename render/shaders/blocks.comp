#version 450 core
// Takes the range of inverse depth of each 4x4 block over all layers.
// in:  w of the layers, four in a texture (1/m; 0 empty, negative partly transparent)
// out: (min, max) of |w| per block in slice 0, empty pixels left out: (+big, 0) where all are empty
// Lee, Eisemann & Seidel 2010, section 3.1, "Multi-Layer Packing"; Decoret 2005.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) writeonly uniform image2DArray ranges;

uniform sampler2D near_w;  // layers 0 to 3
uniform sampler2D far_w;   // layers 4 to 7, where there are so many
uniform bool two_packs;

// The range of four layers' w joined to `range`.
vec2 joined(vec2 range, vec4 stored)
{
    vec4 w = abs(stored);
    vec4 filled = mix(w, vec4(EMPTY_MIN), equal(w, vec4(0.0)));
    return vec2(min(range.x, min(min(filled.x, filled.y), min(filled.z, filled.w))),
                max(range.y, w.x));  // layers come near to far in each pixel
}

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = textureSize(near_w, 0);
    if (any(greaterThanEqual(block, imageSize(ranges).xy))) return;
    vec2 range = vec2(EMPTY_MIN, 0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, size))) continue;
        range = joined(range, texelFetch(near_w, pixel, 0));
        if (two_packs) range = joined(range, texelFetch(far_w, pixel, 0));
    }
    imageStore(ranges, ivec3(block, 0), vec4(range, 0.0, 0.0));
}
