// Surface that a network of MaterialX gives at a fragment.
// The network's functions stand where `#pragma surface_graph` is; they are written by render/stage/materials/mtlx/generation.py:
// samplers, `graph.numbers` by name, the geometry that the network reads, and `evaluate_nodes`, which sets `graph_surface`.
// Colours in a network are linear Rec. 709; its world is the stage's, in the stage's units.

layout(std140, binding = 1) uniform GraphBlock {
    vec4 working_from_rec709[3];  // columns
    vec4 rec709_from_working[3];
    vec4 stage_from_world[4];
    vec4 numbers[GRAPH_NUMBERS];
} graph;

uniform mat4 world_from_camera;
uniform float handedness;       // -1 where the prim's space is mirrored in the world

Surface graph_surface;
float graph_transmission = 0.0; // share of what is not reflected that comes from behind
vec2 graph_uv = vec2(0.0);
vec4 graph_color = vec4(0.0);   // display colour, or the place in the prim's own space
vec3 graph_position = vec3(0.0); // in the stage's world, as are the next three
vec3 graph_normal = vec3(0.0);
vec3 graph_tangent = vec3(0.0);
vec3 graph_bitangent = vec3(0.0);
vec3 graph_eye = vec3(0.0);
float graph_lod_bias = 0.0;

// Linear Rec. 709 in the working space, and back.
vec3 in_working(vec3 color)
{
    return mat3(graph.working_from_rec709[0].xyz, graph.working_from_rec709[1].xyz, graph.working_from_rec709[2].xyz) * color;
}

vec3 from_working(vec3 color)
{
    return mat3(graph.rec709_from_working[0].xyz, graph.rec709_from_working[1].xyz, graph.rec709_from_working[2].xyz) * color;
}

Surface plain_surface()
{
    return Surface(vec3(0.0), vec3(0.0), vec3(0.04), 0.0, 0.5, 1.0, 1.0, 0.0, 0.03, false, graph_normal);
}

vec4 graph_texture(sampler2D map, vec2 uv)
{
    return texture(map, uv, graph_lod_bias);
}

// Further colour of the vertices, linear Rec. 709.
vec3 graph_value_color(int i)
{
    return from_working(value_color(i));
}

// Normal in the prim's own space, of the facet: nothing smoother is known there.
vec3 graph_object_normal()
{
    vec3 facet = cross(dFdx(graph_color.xyz), dFdy(graph_color.xyz));
    float flip = dot(cross(dFdx(graph_position), dFdy(graph_position)), graph_normal) < 0.0 ? -1.0 : 1.0;
    return flip * handedness * facet * inversesqrt(max(dot(facet, facet), 1e-30));
}

#include "layers/graph_surfaces.glsl"

#pragma surface_graph

// Directions in which texture coordinates grow (Mikkelsen 2020, section 3.3), of unit length; any across the normal where there
// are none.
void set_tangents(vec3 n, vec3 p, vec2 uv)
{
    vec3 dpx = dFdx(p), dpy = dFdy(p);
    vec2 dux = dFdx(uv), duy = dFdy(uv);
    vec3 r1 = cross(dpy, n), r2 = cross(n, dpx);
    float flip = dot(dpx, r1) < 0.0 ? -1.0 : 1.0;
    vec3 t = flip * (r1 * dux.x + r2 * duy.x), b = flip * (r1 * dux.y + r2 * duy.y);
    vec3 across = normalize(abs(n.x) < 0.9 ? cross(n, vec3(1.0, 0.0, 0.0)) : cross(n, vec3(0.0, 1.0, 0.0)));
    graph_tangent = dot(t, t) > 1e-30 ? normalize(t) : across;
    graph_bitangent = dot(b, b) > 1e-30 ? normalize(b) : cross(n, graph_tangent);
}

Surface evaluate_material(vec2 uv, vec4 color, vec3 position, vec3 normal, bool front)
{
    mat4 stage_from_world = mat4(graph.stage_from_world[0], graph.stage_from_world[1], graph.stage_from_world[2],
                                 graph.stage_from_world[3]);
    mat4 stage_from_camera = stage_from_world * world_from_camera;
    mat3 turned = mat3(normalize(stage_from_camera[0].xyz), normalize(stage_from_camera[1].xyz),
                       normalize(stage_from_camera[2].xyz));
    vec3 n = facing_normal(position, normal, front);
#ifdef MAY_BE_TRANSPARENT
    graph_lod_bias = -log2(detail);  // cut-outs keep their edges, and both passes must agree on them
#else
    float patch_px = patch_px_m * (fragment_w() - focus.x - dot(focus.yz, gl_FragCoord.xy));
    graph_lod_bias = 0.5 * log2(patch_px * patch_px + 1.0 / (detail * detail));
#endif
    graph_uv = uv;
#ifdef GRAPH_OBJECT_SPACE
    graph_color = color;
#else
    graph_color = vec4(from_working(color.rgb), color.a);
#endif
    graph_position = (stage_from_camera * vec4(position, 1.0)).xyz;
    graph_eye = (stage_from_camera * vec4(0.0, 0.0, eye_z, 1.0)).xyz;
    graph_normal = turned * n;
    set_tangents(graph_normal, graph_position, uv);
    graph_transmission = 0.0;
    graph_surface = plain_surface();
#ifdef GRAPH_MIXED
    mixed_count = 0;
#endif
    evaluate_nodes();

    Surface s = graph_surface;
    s.base_color = in_working(s.base_color);
    s.emissive = in_working(s.emissive);
    s.f0 = in_working(s.f0);
    bool is_mapped = dot(s.normal, s.normal) > 1e-12;
    s.normal = is_mapped ? normalize(s.normal * turned) : n;  // times the transposed: back to the camera
    s.roughness = filtered_roughness(clamp(s.roughness, 0.03, 1.0), s.normal, 0.0);
    s.clearcoat_roughness = filtered_roughness(clamp(s.clearcoat_roughness, 0.03, 1.0), s.normal, 0.0);
    s.clearcoat = clamp(s.clearcoat, 0.0, 1.0);
    s.opacity = clamp(s.opacity, 0.0, 1.0);
    float through = clamp(graph_transmission, 0.0, 1.0);
#ifdef GRAPH_UNLIT
    s.opacity *= 1.0 - through;  // nothing is reflected; layers hold light that is not premultiplied
    if (through > 0.0) s.emissive /= max(1.0 - through, 1.0 / 256.0);
    if (through > 0.0) s.opacity = max(s.opacity, graph_surface.opacity / 256.0);
#else
    if (through > 0.0) {
        // the surface is as opaque as it reflects, and more
        vec3 v = normalize(vec3(0.0, 0.0, eye_z) - position);
        float grazing = pow(1.0 - clamp(abs(dot(s.normal, v)), 0.0, 1.0), 5.0);
        float mirrored = clamp(mix(max(s.f0.r, max(s.f0.g, s.f0.b)), 1.0, grazing), 1e-3, 1.0);
        float opacity = 1.0 - through * (1.0 - mirrored);
        s.is_glass = true;
        s.base_color /= opacity;  // of what is not let through, and so not faded
        s.f0 *= s.opacity;        // a cut-out fades all
        s.emissive *= s.opacity;
        s.clearcoat *= s.opacity;
        s.opacity *= opacity;
    }
#endif
    return s;
}
