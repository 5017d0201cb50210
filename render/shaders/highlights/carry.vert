#version 450 core
// Quad over the pixels that a highlight's blurred image covers.
// in:  a highlight for each instance
// out: the highlight

in vec4 in_box;         // first and last place, pixels
in vec4 in_excess;      // radiance times opacity; w (1/m)
in vec2 in_place;       // in the layers, pixels
in uint in_front;       // bits of the inverse depth from which on surfaces are in the way
in uvec2 in_bins;       // bins of inverse depth that may hold such surfaces

uniform vec2 picture;   // its size, pixels

flat out vec4 excess;
flat out vec2 source;
flat out uint front;
flat out uvec2 bins_in_way;

void main()
{
    excess = in_excess;
    source = in_place;
    front = in_front;
    bins_in_way = in_bins;
    vec2 place = mix(in_box.xy, in_box.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
    gl_Position = vec4(place / picture * 2.0 - 1.0, 0.0, 1.0);
}
