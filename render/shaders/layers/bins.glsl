// Even bins of inverse depth over a range that holds all surfaces, 64 of them, as bits of a uvec2: bit 0 is farthest.

const int BINS = 64;

// Bin of w in a picture whose surfaces lie between `all.x` and `all.y`.
int bin_of(float w, vec2 all)
{
    float place = (w - all.x) / max(all.y - all.x, 1e-9 * all.y) * float(BINS);
    return int(clamp(place, 0.0, float(BINS - 1)));  // clamped first: an int holds no larger number
}

// Bits from `low` to `high`, both included.
uvec2 bits_between(int low, int high)
{
    uvec2 from = low < 32 ? uvec2(0xffffffffu << low, 0xffffffffu) : uvec2(0u, 0xffffffffu << (low - 32));
    uvec2 to = high < 32 ? uvec2(0xffffffffu >> (31 - high), 0u) : uvec2(0xffffffffu, 0xffffffffu >> (63 - high));
    return from & to;
}
