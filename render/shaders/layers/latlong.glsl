// A direction's place in a latitude-longitude image as OpenEXR has it: the centre looks along +Z, +X is left of it, row 0 up.
vec2 latlong_uv(vec3 d)
{
    const float pi = 3.14159265358979;
    float longitude = abs(d.x) + abs(d.z) > 0.0 ? atan(d.x, d.z) : 0.0;  // straight up and down have none
    return vec2(0.5 - longitude / (2.0 * pi), acos(clamp(d.y, -1.0, 1.0)) / pi);
}
