#version 430
// Share of a ghost's light that the iris and the rims pass, at each crossing.

uniform sampler2D iris;  // transmission over the square around the unit circle with a dark edge, row 0 at the top
uniform float inner;     // share of the texture without the edge

in vec2 on_first;
in vec2 on_second;
in vec2 on_third;
in float rim;
in vec3 radiance;

out vec4 color;

float through(vec2 stop) {
    return texture(iris, 0.5 + 0.5 * inner * vec2(stop.x, -stop.y)).r;
}

void main() {
    float edge = max(fwidth(rim), 1e-6);
    float open = clamp((1.0 - rim) / edge + 0.5, 0.0, 1.0);
    float passed = through(on_first) * through(on_second) * through(on_third) * open;
    color = vec4(radiance * passed, 0.0);
}
