#version 450 core
// Packs the layers' inverse depths into one texture and takes the range of each 4x4 block over all layers.
// in:  w of each layer (1/m; 0 empty, negative partly transparent)
// out: the four w in one texel; (min, max) of |w| per block, empty pixels left out: (+big, 0) where all are empty
// Lee, Eisemann & Seidel 2010, section 3.1, "Multi-Layer Packing"; Decoret 2005.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D packed_w;
layout(rg32f, binding = 1) writeonly uniform image2DArray ranges;

uniform sampler2D layer_w[4];
uniform int count;

void main()
{
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = imageSize(packed_w);
    if (any(greaterThanEqual(block, imageSize(ranges).xy))) return;
    vec2 range = vec2(EMPTY_MIN, 0.0);
    for (int i = 0; i < 16; ++i) {
        ivec2 pixel = block * 4 + ivec2(i & 3, i >> 2);
        if (any(greaterThanEqual(pixel, size))) continue;
        vec4 w = vec4(0.0);
        w.x = texelFetch(layer_w[0], pixel, 0).r;
        if (count > 1) w.y = texelFetch(layer_w[1], pixel, 0).r;
        if (count > 2) w.z = texelFetch(layer_w[2], pixel, 0).r;
        if (count > 3) w.w = texelFetch(layer_w[3], pixel, 0).r;
        imageStore(packed_w, pixel, w);
        vec4 a = abs(w);
        range.y = max(range.y, a.x);  // layers come near to far in each pixel
        vec4 filled = mix(a, vec4(EMPTY_MIN), equal(a, vec4(0.0)));
        range.x = min(range.x, min(min(filled.x, filled.y), min(filled.z, filled.w)));
    }
    imageStore(ranges, ivec3(block, 0), vec4(range, 0.0, 0.0));
}
