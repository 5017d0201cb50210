// Light of a tube: a cylinder that shines all around, and whose ends are dark.
// Diffuse: the closed form of a thin line (Heitz & Hill 2017, "Linear-light shading with linearly transformed cosines", section
// 3), cut at the horizon. The line stands for the side that is seen: it lies where that shines from on the average, pi/4 of the
// radius before the axis. So it is exact for an infinite tube that a surface faces, and far away.
// Highlights: of the tube's point nearest to the mirrored ray (Karis 2013, "Real shading in Unreal Engine 4"), times the
// integral of the GGX profile along the tube, so that a highlight keeps its light.

// Integral of 1 / (1 + u²)², the profile of a GGX lobe along a line.
float lobe_integral(float u)
{
    return 0.5 * (u / (1.0 + u * u) + atan(u));
}

// Solid angle of a tube over that of a unit of it at its foot, weighed by a lobe relative to its value at the point that stands for
// the tube. Angles along the tube, as seen from the surface: its ends, that point, the mirrored ray's. `narrow` is the angle along
// the tube over twice that of half vectors, and `off` half the angle from the mirrored ray to the tube's line.
float weighed_angle(float alpha, float spread, float off, float narrow, vec2 ends, float shown, float mirrored)
{
    float width = 2.0 * narrow * sqrt(alpha * alpha + spread * spread + off * off), first = ends.x, last = ends.y;
    float centre = clamp(mirrored, first - 8.0 * width, last + 8.0 * width);
    float from = (first - centre) / width, to = (last - centre) / width, at = (shown - centre) / width;
    float span = to - from, profile = 1.0 + at * at;
    float mean = span > 1e-2 ? (lobe_integral(to) - lobe_integral(from)) / span : 1.0 / (profile * profile);
    float angle = min(mean * profile * profile, 1.0) * (last - first);
    return 2.0 * sin(0.5 * angle) * cos(clamp(shown, first + 0.5 * angle, last - 0.5 * angle));
}

Reflected tube_contribution(Light light, Reflector s, vec3 p, vec3 v)
{
    vec3 centre = light.position_kind.xyz - p;
    float half_m = length(light.tube_focus.xyz), radius = light.axis_radius.w;
    vec3 axis = light.tube_focus.xyz / half_m;
    float along = dot(centre, axis);
    vec3 foot = centre - along * axis;      // the nearest point of the tube's line
    float far2 = max(dot(foot, foot), max(radius * radius, 1e-8));
    float nearer = 1.0 - 0.25 * PI * radius * inversesqrt(far2), h2 = nearer * nearer * far2, h = sqrt(h2);
    foot *= nearer;
    radius *= nearer;  // as wide as before from the surface
    vec3 l = normalize(centre);
    // the part above the horizon, as distances along the line from its foot
    float rise = dot(s.normal, axis), height = dot(s.normal, foot);
    float from = along - half_m, to = along + half_m;
    if (abs(rise) > 1e-6) {
        float horizon = -height / rise;
        if (rise > 0.0) from = max(from, horizon);
        else to = min(to, horizon);
    } else if (height <= 0.0) to = from;
    if (to <= from) return Reflected(vec3(0.0), vec3(0.0));
    float from2 = h2 + from * from, to2 = h2 + to * to;
    float first = atan(from / h), last = atan(to / h);
    float straight = 0.5 * (to / to2 - from / from2 + (last - first) / h) / h2;
    float sideways = 0.5 * (1.0 / from2 - 1.0 / to2);
    float facing_light = max(2.0 * radius * h * (height * straight + rise * sideways), 0.0);
    // the point that stands for it in highlights
    vec3 mirror = reflect(-v, s.normal);
    float mirror_along = dot(mirror, axis), mirror_across = dot(mirror, foot) / h;
    float mirrored = atan(mirror_along, mirror_across);
    float shown = clamp(mirrored, first, last);
    vec3 seen = foot + h * tan(shown) * axis;
    float d = length(seen);
    vec3 toward = seen / max(d, 1e-8);
    float line_cosine = length(vec2(mirror_along, mirror_across));
    float off = sqrt(max(0.5 - 0.5 * line_cosine, 0.0)), spread = 0.5 * radius / max(d, radius);
    vec3 half_vector = normalize(toward + v);
    float nl = max(dot(s.normal, toward), 0.0), nv = max(abs(dot(s.normal, v)), 1e-3);
    float nh = clamp(dot(s.normal, half_vector), 0.0, 1.0), vh = clamp(dot(v, half_vector), 0.0, 1.0);
    // across the plane of incidence half vectors turn faster, the more so the more grazing the light
    vec3 side = cross(v, s.normal), tangent = normalize(axis - dot(axis, toward) * toward);
    float across = dot(tangent, side) * dot(tangent, side) / max(dot(side, side), 1e-6);
    float narrow = inversesqrt(1.0 - across + across / max(vh * vh, 1e-4));
    vec2 ends = vec2(first, last);
    float alpha = s.roughness * s.roughness;
    float lobe = ggx(nh, nl, nv, alpha, spread) * weighed_angle(alpha, spread, off, narrow, ends, shown, mirrored);
    vec3 mirrored_light = fresnel(s.f0, vh) * lobe;
#ifdef CLEARCOAT
    float coat = s.clearcoat_roughness * s.clearcoat_roughness + 1e-3;
    float coat_light = ggx(nh, nl, nv, coat, spread) * weighed_angle(coat, spread, off, narrow, ends, shown, mirrored);
    mirrored_light += s.clearcoat * fresnel(vec3(0.04), vh).r * coat_light;
#endif
    vec3 radiance = light.radiance_area.rgb * shaping(light, -l);
    return Reflected(radiance * (facing_light / PI * light.cone_response.z) * (1.0 - fresnel(s.f0, vh)),
                     radiance * mirrored_light * (2.0 * radius / h * nl * light.cone_response.w));
}
