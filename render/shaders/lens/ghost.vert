#version 430
// Vertices of a ghost's sheet of rays over the picture.

uniform vec2 picture;  // pixels

in vec2 place;  // pixels, y down
in vec2 first_stop;
in vec2 second_stop;
in vec2 third_stop;
in float near_rim;
in vec3 light;

out vec2 on_first;
out vec2 on_second;
out vec2 on_third;
out float rim;
out vec3 radiance;

void main() {
    gl_Position = vec4(place / picture * 2.0 - 1.0, 0.0, 1.0);
    on_first = first_stop;
    on_second = second_stop;
    on_third = third_stop;
    rim = near_rim;
    radiance = light;
}
