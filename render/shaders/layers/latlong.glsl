// Texture coordinates of a direction in a latitude-longitude image, as in OpenEXR: the centre is +Z, +X is left of it, row 0 is up.
vec2 latlong_uv(vec3 d)
{
    const float pi = 3.14159265358979;
    float longitude = abs(d.x) + abs(d.z) > 0.0 ? atan(d.x, d.z) : 0.0;  // undefined straight up and down
    return vec2(0.5 - longitude / (2.0 * pi), acos(clamp(d.y, -1.0, 1.0)) / pi);
}
