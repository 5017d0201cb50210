// Table of what the rays of a pixel meet: numbers of surfaces and the weight of the rays that meet them.
// Exact while a pixel meets no more than SLOTS surfaces. A further one takes over the slot of the least weight, with that weight
// (Space-Saving; Metwally, Agrawal & El Abbadi 2005): the sum stays right, a surface of more than 1/SLOTS of it is never lost, and
// none gets more than 1/SLOTS of it too much.
// Where DEEP is defined, a surface counts as another one at each step of its depth, and its light and inverse depth are summed too.

layout(rg32ui, binding = 1) uniform uimage2DArray matte_table;  // number and bits of the weight; SLOTS slices, 0 where not used
layout(std430, binding = 0) readonly buffer MatteObjects { uvec2 matte_objects[]; };    // of each object: where its numbers begin,
                                                                                        // 1 where each triangle has its own
layout(std430, binding = 2) readonly buffer MatteNumbers { uint matte_numbers[]; };
#ifdef DEEP
layout(rgba32f, binding = 2) uniform image2DArray light_table;  // red, green, blue, and inverse depth (1/m), times the weight
const float STEPS_PER_OCTAVE = 8.0; // of depth; 256 steps from the near plane on
uniform float nearest_w;            // w of the near plane, 1/m: the same in all moments and tiles
#endif
uniform usampler2DArray surface_ids;    // object + 1 and triangle of the layers' surfaces

uint slot_number[SLOTS];
float slot_weight[SLOTS];
int slots_used = 0;
uint last_number = 0u;  // of the surface met last, whose weight is not in the slots yet: mostly the next ray meets it too
float last_weight = 0.0;
float ray_share;        // of the ray that is marched in the pixel's sum
#ifdef DEEP
vec4 slot_light[SLOTS];
vec4 last_light = vec4(0.0);
vec3 light_share;       // of the ray, in red, green and blue
#endif

void add_to_slots(uint number, float weight)
{
    int at = 0;
    for (int i = 0; i < slots_used; ++i) {
        if (slot_number[i] == number) {
            slot_weight[i] += weight;
#ifdef DEEP
            slot_light[i] += last_light;
#endif
            return;
        }
        if (slot_weight[i] < slot_weight[at]) at = i;
    }
    if (slots_used < SLOTS) {
        at = slots_used++;
        slot_weight[at] = 0.0;
#ifdef DEEP
        slot_light[at] = vec4(0.0);
#endif
    }
    slot_number[at] = number;
    slot_weight[at] += weight;
#ifdef DEEP
    slot_light[at] += last_light;
#endif
}

// Note something by its number: what it adds to the ray's light and coverage, and its inverse depth.
void note(uint number, vec4 light, float w)
{
    if (light.a == 0.0) return;  // a holdout
#ifdef DEEP
    number = number << 8 | uint(clamp(STEPS_PER_OCTAVE * log2(nearest_w / w), 0.0, 255.0));
#endif
    if (number != last_number) {
        if (last_number != 0u) add_to_slots(last_number, last_weight);
        last_number = number;
        last_weight = 0.0;
#ifdef DEEP
        last_light = vec4(0.0);
#endif
    }
    last_weight += ray_share * light.a;
#ifdef DEEP
    last_light += vec4(light_share * light.rgb, ray_share * light.a * w);
#endif
}

// Note the surface of a texel, at the inverse depth of the texel: planes of texels reach beyond silhouettes.
void note_surface(ivec3 texel, vec4 light, float w)
{
    uvec2 surface = texelFetch(surface_ids, texel, 0).xy, object = matte_objects[surface.x - 1u];
    note(matte_numbers[object.x + object.y * surface.y], light, w);
}

// Continue the table of a pixel.
void load_slots(ivec2 pixel)
{
    for (int i = 0; i < SLOTS; ++i) {
        uvec2 stored = imageLoad(matte_table, ivec3(pixel, i)).xy;
        if (stored.x == 0u) break;
        slot_number[i] = stored.x;
        slot_weight[i] = uintBitsToFloat(stored.y);
#ifdef DEEP
        slot_light[i] = imageLoad(light_table, ivec3(pixel, i));
#endif
        slots_used = i + 1;
    }
}

void store_slots(ivec2 pixel)
{
    if (last_number != 0u) add_to_slots(last_number, last_weight);
    for (int i = 0; i < slots_used; ++i) {
        uvec2 slot = uvec2(slot_number[i], floatBitsToUint(slot_weight[i]));
        imageStore(matte_table, ivec3(pixel, i), uvec4(slot, 0u, 0u));
#ifdef DEEP
        imageStore(light_table, ivec3(pixel, i), slot_light[i]);
#endif
    }
}
