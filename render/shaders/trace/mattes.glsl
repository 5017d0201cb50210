// Table of what the rays of a pixel meet: numbers of surfaces and the weight of the rays that meet them.
// Exact while a pixel meets no more than SLOTS surfaces. A further one takes over the slot of the least weight, with that weight
// (Space-Saving; Metwally, Agrawal & El Abbadi 2005): the sum stays right, a surface of more than 1/SLOTS of it is never lost, and
// none gets more than 1/SLOTS of it too much.

layout(rg32ui, binding = 1) uniform uimage2DArray matte_table;  // number and bits of the weight; SLOTS slices, 0 where not used
layout(std430, binding = 0) readonly buffer MatteObjects { uvec2 matte_objects[]; };    // of each object: where its numbers begin,
                                                                                        // 1 where each triangle has its own
layout(std430, binding = 2) readonly buffer MatteNumbers { uint matte_numbers[]; };
uniform usampler2DArray surface_ids;    // object + 1 and triangle of the layers' surfaces

uint slot_number[SLOTS];
float slot_weight[SLOTS];
int slots_used = 0;
uint last_number = 0u;  // of the surface met last, whose weight is not in the slots yet: mostly the next ray meets it too
float last_weight = 0.0;
float ray_share;        // of the ray that is marched in the pixel's sum

void add_to_slots(uint number, float weight)
{
    int at = 0;
    for (int i = 0; i < slots_used; ++i) {
        if (slot_number[i] == number) {
            slot_weight[i] += weight;
            return;
        }
        if (slot_weight[i] < slot_weight[at]) at = i;
    }
    if (slots_used < SLOTS) {
        at = slots_used++;
        slot_weight[at] = 0.0;
    }
    slot_number[at] = number;
    slot_weight[at] += weight;
}

// Note the surface of a texel, which lets a part of the ray's light through.
void note_surface(ivec3 texel, float opacity)
{
    uvec2 surface = texelFetch(surface_ids, texel, 0).xy, object = matte_objects[surface.x - 1u];
    uint number = matte_numbers[object.x + object.y * surface.y];
    if (number != last_number) {
        if (last_number != 0u) add_to_slots(last_number, last_weight);
        last_number = number;
        last_weight = 0.0;
    }
    last_weight += ray_share * opacity;
}

// Continue the table of a pixel.
void load_slots(ivec2 pixel)
{
    for (int i = 0; i < SLOTS; ++i) {
        uvec2 stored = imageLoad(matte_table, ivec3(pixel, i)).xy;
        if (stored.x == 0u) break;
        slot_number[i] = stored.x;
        slot_weight[i] = uintBitsToFloat(stored.y);
        slots_used = i + 1;
    }
}

void store_slots(ivec2 pixel)
{
    if (last_number != 0u) add_to_slots(last_number, last_weight);
    for (int i = 0; i < slots_used; ++i) {
        uvec2 slot = uvec2(slot_number[i], floatBitsToUint(slot_weight[i]));
        imageStore(matte_table, ivec3(pixel, i), uvec4(slot, 0u, 0u));
    }
}
