#version 450 core
// Film or sensor response, as in render/film/process.py and sensor.py.
// in:  light, exposed and balanced; with HALATION the light that the base spreads; with GRAIN or SMOOTH_GRAIN noise; the stock's
//      tables, RECORDS rows each: density over log exposure, granularity over density, the PRINT's density over log exposure
// out: light of the print or positive on the screen, 1 where it is clear; with a SENSOR, or with neither, scene-linear light

layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 0, rgba32f) writeonly uniform image2D developed;

#include "film/film_light.glsl"
#include "film/noise.glsl"

#ifdef HALATION
layout(std430, binding = 0) readonly buffer Spread { vec4 spread[]; };
uniform int spread_width;
uniform ivec2 reach;
uniform vec3 shares;

vec3 light_at(ivec2 pixel)
{
    vec3 direct = exposed_at(pixel);
    ivec2 place = pixel + reach;
    return direct + shares * (spread[place.y * spread_width + place.x].rgb - direct);
}
#else
#define light_at exposed_at
#endif

#if defined(GRAIN) || defined(SMOOTH_GRAIN)
uniform float grain_scale;  // factor on the noise, including the amount of grain
#ifdef SMOOTH_GRAIN
layout(std430, binding = 1) readonly buffer Noise { vec4 smooth_noise[]; };

vec3 grain_at(ivec2 pixel, int width) { return grain_scale * smooth_noise[pixel.y * width + pixel.x].rgb; }
#else
vec3 grain_at(ivec2 pixel, int width) { return grain_scale * normal_noise(pixel).rgb; }
#endif
#endif

#ifdef RECORDS
uniform sampler2D tables;
uniform vec3 curve_begins, curve_steps;  // first value of each record's row, and steps per unit
uniform vec3 grain_begins, grain_steps;
uniform vec3 print_begins, print_steps;
uniform vec3 exposure_offset; // log exposure of each record at light 1, push included
uniform vec3 printer_lights;
uniform vec3 clear;           // density of clear film

const float DARKEST = 1e-7;
const float LOG10_2 = 0.30102999566;

float table_at(int row, float place)
{
    int last = textureSize(tables, 0).x - 1;
    place = clamp(place, 0.0, float(last));
    int left = min(int(place), last - 1);
    float here = texelFetch(tables, ivec2(left, row), 0).r, there = texelFetch(tables, ivec2(left + 1, row), 0).r;
    return here + (place - float(left)) * (there - here);
}

vec3 film_light(ivec2 pixel, int width)
{
    vec3 lit = light_at(pixel);
    if (RECORDS == 1) lit = vec3((lit.r + lit.g + lit.b) / 3.0);
    vec3 exposures = LOG10_2 * log2(max(lit, vec3(DARKEST))) + exposure_offset;
#if defined(GRAIN) || defined(SMOOTH_GRAIN)
    vec3 grain = grain_at(pixel, width);
#endif
    vec3 shown;
    for (int record = 0; record < RECORDS; ++record) {
        float density = table_at(record, (exposures[record] - curve_begins[record]) * curve_steps[record]);
#if defined(GRAIN) || defined(SMOOTH_GRAIN)
        float granularity = table_at(RECORDS + record, (density - grain_begins[record]) * grain_steps[record]);
        density = max(density + grain[record] * granularity, 0.0);
#endif
#ifdef PRINT
        float printed = printer_lights[record] - density;
        density = table_at(2 * RECORDS + record, (printed - print_begins[record]) * print_steps[record]);
#endif
        shown[record] = exp2((clear[record] - density) / LOG10_2);
    }
    return RECORDS == 1 ? shown.rrr : shown;
}
#endif

#ifdef SENSOR
uniform vec3 electrons;      // electrons of one photosite of each channel at light 1
uniform float read_variance; // variance in electrons squared
uniform float averaged;      // photosites in each pixel
uniform float clip;

vec3 sensor_light(ivec2 pixel)
{
    vec3 counted = electrons * light_at(pixel);
    vec3 variance = (max(counted, 0.0) + read_variance) / averaged;
    return min((counted + sqrt(variance) * normal_noise(pixel).rgb) / electrons, clip);
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, imageSize(developed)))) return;
#if defined(RECORDS)
    vec3 result = film_light(pixel, imageSize(developed).x);
#elif defined(SENSOR)
    vec3 result = sensor_light(pixel);
#else
    vec3 result = light_at(pixel);
#endif
    imageStore(developed, pixel, vec4(result, 1.0));
}
