#version 450 core
// Quad over the pixels that a highlight's blurred image covers.
// in:  a highlight for each instance
// out: the highlight

in vec4 in_box;         // first and last place, whole pixels
in vec4 in_excess;      // radiance times opacity times area (layer pixels²); w seen from the picture's camera (1/m)
in vec4 in_place;       // in the picture's frame; inverse depth on the layers from which on surfaces are in the way; side, layer pixels

uniform ivec2 area_first;   // pixel of the picture at the corner of the area that is drawn
uniform vec2 area_size;     // pixels

flat out vec4 excess;
flat out vec4 place;

void main()
{
    excess = in_excess;
    place = in_place;
    vec2 corner = mix(in_box.xy, in_box.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1)) - vec2(area_first);
    gl_Position = vec4(corner / area_size * 2.0 - 1.0, 0.0, 1.0);
}
