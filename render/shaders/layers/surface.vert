#version 450 core
// Transform the vertices of a batch into camera space.
// in:  positions (m), normals, texture coordinates, display colour; one pose for each instance (pyrender's attributes)
// out: camera-space position (m) and normal, texture coordinates, colour, and the instance's number; where MOVES is defined,
//      the vertex's motion in both halves of the exposure (m: x right, y down, z away from the eye)

layout(location = 0) in vec3 position;
layout(location = NORMAL_LOC) in vec3 normal;
#ifdef TEXCOORD_0_LOC
layout(location = TEXCOORD_0_LOC) in vec2 texcoord_0;
#endif
#ifdef COLOR_0_LOC
layout(location = COLOR_0_LOC) in vec4 color_0;
#endif
#ifdef VALUES_0_LOC
layout(location = VALUES_0_LOC) in vec4 values_0;
layout(location = VALUES_1_LOC) in vec2 values_1;
out vec4 frag_values_0;
out vec2 frag_values_1;
#endif
layout(location = INST_M_LOC) in mat4 inst_m;

#ifdef MOVES
layout(std430, binding = 0) readonly buffer Poses { mat4 poses[]; };            // camera from geometry, for each instance: opening, middle, closing
#ifdef BENDS
layout(std430, binding = 1) readonly buffer EndPositions { float end_positions[]; }; // of each vertex: opening, closing
#endif
out vec3 frag_first;
out vec3 frag_second;
#endif
#ifdef INSTANCE_COLORS
layout(std430, binding = 2) readonly buffer InstanceColors { vec4 instance_colors[]; };
#endif

#ifdef CLIP_PLANES
uniform vec4 clip_planes[CLIP_PLANES];  // camera space; nothing is drawn where a plane's value is negative
out float gl_ClipDistance[CLIP_PLANES];
invariant gl_ClipDistance;
#endif

uniform mat4 camera_from_node;
uniform mat4 clip_from_camera;
uniform int first_instance;     // first instance of the draw

out vec3 frag_position;
out vec3 frag_normal;
out vec2 frag_uv;
out vec4 frag_color;
flat out uint frag_instance;

invariant gl_Position;  // every peeling pass must get the same depth at a pixel

// Normals transform by the cofactor matrix: the inverse transpose times the determinant, whose sign a mirror flips.
mat3 cofactor(mat3 m)
{
    return mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
}

#ifdef MOVES
// Motion of the vertex in both halves of the exposure.
void move(out vec3 first, out vec3 second)
{
    vec3 from = position, to = position;
#ifdef BENDS
    int i = 6 * gl_VertexID;
    from = vec3(end_positions[i], end_positions[i + 1], end_positions[i + 2]);
    to = vec3(end_positions[i + 3], end_positions[i + 4], end_positions[i + 5]);
#endif
    int instance = first_instance + gl_InstanceID;
    vec3 middle = (poses[3 * instance + 1] * vec4(position, 1.0)).xyz;
    first = (middle - (poses[3 * instance] * vec4(from, 1.0)).xyz) * vec3(1.0, -1.0, -1.0);
    second = ((poses[3 * instance + 2] * vec4(to, 1.0)).xyz - middle) * vec3(1.0, -1.0, -1.0);
}
#endif

void main()
{
    mat4 camera_from_local = camera_from_node * inst_m;
    vec4 p = camera_from_local * vec4(position, 1.0);
    mat3 c = cofactor(mat3(camera_from_local));
    frag_position = p.xyz;
    frag_normal = c * normal * (dot(c[0], camera_from_local[0].xyz) < 0.0 ? -1.0 : 1.0);
#ifdef TEXCOORD_0_LOC
    frag_uv = texcoord_0;
#else
    frag_uv = vec2(0.0);
#endif
#ifdef COLOR_0_LOC
    frag_color = color_0;
#else
    frag_color = vec4(1.0);
#endif
#ifdef VALUES_0_LOC
    frag_values_0 = values_0;
    frag_values_1 = values_1;
#endif
#ifdef INSTANCE_COLORS
    frag_color *= instance_colors[first_instance + gl_InstanceID];
#endif
    frag_instance = uint(first_instance + gl_InstanceID);
#ifdef MOVES
    move(frag_first, frag_second);
#endif
#ifdef CLIP_PLANES
    for (int i = 0; i < CLIP_PLANES; i++) gl_ClipDistance[i] = dot(clip_planes[i], p);
#endif
    gl_Position = clip_from_camera * p;
}
