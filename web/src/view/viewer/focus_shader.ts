/** Programs that draw how sharp a picture is, in GLSL ES 3.00. */

/** A triangle that covers the canvas. */
export const VERTICES = `#version 300 es
void main() {
  gl_Position = vec4(4.0 * float(gl_VertexID & 1) - 1.0, 4.0 * float(gl_VertexID >> 1) - 1.0, 0.0, 1.0);
}`;

/**
 * Colours are premultiplied. Where nothing is to be said the result is clear, or with false colour the whole picture is coloured.
 *
 * A line is drawn where the circle of confusion passes a level on a surface. Slopes are the smaller ones of both sides, so that the
 * edge of a thing, where the circle jumps, is no line.
 */
export const FRAGMENTS = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D circles;  // radius of the circle of confusion, px of the map, negative in front of the focus
uniform sampler2D picture;
uniform vec2 canvas;  // px
uniform float limit;  // largest radius that is sharp, px of the map
uniform int look;     // 0: none, 1: peaking, 2: false colour
uniform bool lines;
out vec4 paint;

const vec3 PEAK = vec3(1.0, 0.16, 0.16);

float circleAt(ivec2 pixel) {
  return texelFetch(circles, clamp(pixel, ivec2(0), textureSize(circles, 0) - 1), 0).r;
}

float luminance(vec2 at) {
  return dot(texture(picture, at).rgb, vec3(0.2126, 0.7152, 0.0722));
}

/** Contrast of the picture at a place: the slope of its luminance over a pixel of the canvas. */
float contrast(vec2 at) {
  vec2 right = vec2(1.0 / canvas.x, 0.0), down = vec2(0.0, 1.0 / canvas.y);
  return length(vec2(luminance(at + right) - luminance(at - right), luminance(at + down) - luminance(at - down)));
}

/** Colour of a circle: green where it is sharp, warm in front and cold behind, a step for every two stops. */
vec3 falseColour(float circle) {
  float ratio = abs(circle) / limit;
  if (ratio <= 1.0) return vec3(0.25, 0.85, 0.35);
  float steps = min(floor(log2(ratio)), 3.0);
  vec3 near = mix(vec3(1.0, 0.85, 0.2), vec3(0.8, 0.1, 0.1), steps / 3.0);
  vec3 far = mix(vec3(0.25, 0.85, 0.95), vec3(0.35, 0.2, 0.85), steps / 3.0);
  return circle < 0.0 ? near : far;
}

float slope(ivec2 pixel, ivec2 by, float here) {
  return min(abs(here - circleAt(pixel - by)), abs(circleAt(pixel + by) - here));
}

/**
 * Coverage of a line of that many pixels of the canvas, where the circle has a level. There is none on a surface that stands in the
 * focus as a whole, and none where all that is sharp would be thinner than the lines, as among leaves.
 */
float lineAt(float circle, float rise, float level, float width) {
  if (rise < 1e-4 * limit || rise > limit) return 0.0;
  float scale = canvas.x / float(textureSize(circles, 0).x);
  return 1.0 - smoothstep(0.5 * width - 0.5, 0.5 * width + 0.5, abs(circle - level) / rise * scale);
}

vec4 over(vec4 below, vec3 colour, float coverage) {
  return vec4(colour * coverage, coverage) + below * (1.0 - coverage);
}

void main() {
  vec2 at = vec2(gl_FragCoord.x, canvas.y - gl_FragCoord.y) / canvas;
  ivec2 pixel = ivec2(at * vec2(textureSize(circles, 0)));
  float circle = circleAt(pixel);
  paint = vec4(0.0);
  if (look == 1 && abs(circle) <= limit) {
    paint = over(paint, PEAK, mix(0.2, 0.9, smoothstep(0.03, 0.2, contrast(at))));
  } else if (look == 2) {
    paint = vec4(falseColour(circle) * (0.2 + 0.8 * luminance(at)), 1.0);
  }
  if (!lines) return;
  float rise = length(vec2(slope(pixel, ivec2(1, 0), circle), slope(pixel, ivec2(0, 1), circle)));
  float nearest = lineAt(circle, rise, -limit, 1.6), farthest = lineAt(circle, rise, limit, 1.6);
  float halo = max(lineAt(circle, rise, 0.0, 4.0), max(lineAt(circle, rise, -limit, 3.4), lineAt(circle, rise, limit, 3.4)));
  paint = over(paint, vec3(0.0), 0.55 * halo);
  paint = over(paint, vec3(1.0, 0.8, 0.2), nearest);
  paint = over(paint, vec3(0.3, 0.85, 1.0), farthest);
  paint = over(paint, vec3(1.0), lineAt(circle, rise, 0.0, 2.0));
}`;
