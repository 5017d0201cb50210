#version 450 core
// Choose, of each pixel's sixteen runs of splats, the one within which they pass one half of opacity.
// in:  what each run hides (opacity_bins.frag), and what is known of each pixel
// out: the number of the chosen run's first splat, and what those in front of it hide; -1 where all of them hide less than half

layout(local_size_x = 8, local_size_y = 8) in;
layout(rg32f, binding = 0) uniform image2D known;

uniform sampler2D runs_0, runs_1, runs_2, runs_3;
uniform float run_length;   // splats of a run
uniform bool is_first;      // whether nothing was chosen yet

const float HALF = 0.6931471805599453;  // -log(1/2)

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(known)))) return;
    vec2 found = imageLoad(known, pixel).xy;
    if (found.x < 0.0) return;
    float runs[16];
    vec4 four = texelFetch(runs_0, pixel, 0);
    for (int i = 0; i < 4; ++i) runs[i] = four[i];
    four = texelFetch(runs_1, pixel, 0);
    for (int i = 0; i < 4; ++i) runs[4 + i] = four[i];
    four = texelFetch(runs_2, pixel, 0);
    for (int i = 0; i < 4; ++i) runs[8 + i] = four[i];
    four = texelFetch(runs_3, pixel, 0);
    for (int i = 0; i < 4; ++i) runs[12 + i] = four[i];
    int chosen = -1;
    float hidden = found.y, before = found.y;
    for (int i = 0; i < 16 && hidden < HALF; ++i) {
        if (runs[i] == 0.0) continue;
        chosen = i;     // the last of them, where rounding leaves less than before
        before = hidden;
        hidden += runs[i];
    }
    if (chosen < 0 || (is_first && hidden < HALF)) found = vec2(-1.0, 0.0);
    else found = vec2(found.x + float(chosen) * run_length, before);
    imageStore(known, pixel, vec4(found, 0.0, 0.0));
}
