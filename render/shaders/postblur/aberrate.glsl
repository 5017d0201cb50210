// Picture errors of a lens over the height in the picture, shared by the image-space passes
// (render/postblur/picture_errors.py).
// Positions are slopes of pixel centres, x right and y down; errors are slopes too, and `focal_px` converts them to pixels.
// A row has source, even, along and across, each for red, green and blue, then coma and light.

layout(local_size_x = 8, local_size_y = 8) in;
layout(rgba32f, binding = 0) writeonly uniform image2D target;
layout(std430, binding = 4) readonly buffer Rows { float rows[]; };  // ROW_LENGTH each, see below

uniform sampler2D picture;
uniform int first_row;      // of this dispatch
uniform int row_count;
uniform float last;         // height of the last row
uniform vec2 centre;        // pixels
uniform vec2 focal_px;      // focal length of the picture
uniform float squeeze;      // anamorphic squeeze, by which bending and blur are narrower from side to side

ivec2 own_pixel() { return ivec2(gl_GlobalInvocationID.xy) + ivec2(0, first_row); }

float error_at(float height, int field)
{
    float at = clamp(height / last, 0.0, 1.0) * float(row_count - 1);
    int low = min(int(at), row_count - 2);
    return mix(rows[low * ROW_LENGTH + field], rows[(low + 1) * ROW_LENGTH + field], at - float(low));
}

vec3 errors_at(float height, int field)
{
    return vec3(error_at(height, field), error_at(height, field + 1), error_at(height, field + 2));
}

vec2 place_of(ivec2 pixel) { return (vec2(pixel) + 0.5 - centre) / focal_px; }

vec2 outward_of(vec2 place)
{
    float height = length(place);
    return height > 0.0 ? place / height : vec2(1.0, 0.0);
}

vec2 narrowed_px() { return vec2(focal_px.x / squeeze, focal_px.y); }

vec4 texel(ivec2 at) { return texelFetch(picture, clamp(at, ivec2(0), textureSize(picture, 0) - 1), 0); }

// Bilinear sample at a position in pixels, with texel centres at whole numbers; in full precision, unlike a sampler's.
vec4 bilinear(vec2 at)
{
    ivec2 low = ivec2(floor(at));
    vec2 part = at - vec2(low);
    return mix(mix(texel(low), texel(low + ivec2(1, 0)), part.x),
               mix(texel(low + ivec2(0, 1)), texel(low + ivec2(1, 1)), part.x), part.y);
}
