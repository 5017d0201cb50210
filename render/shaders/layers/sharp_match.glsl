// Whether a surface of a texel of the layers goes on to a place nearby: its plane predicts the inverse depth there.

const float ALIKE = 0.003;      // relative difference of w within which places lie on one surface

// Relative error of the predictions of four surfaces for `w` at `off` texels from the texel's centre; 1 where there is no opaque one.
vec4 prediction_errors(vec4 stored, uvec4 held, vec2 off, float w)
{
    vec4 predicted = stored * (1.0 + unpacked_slopes(held) * off.x + unpacked_slopes(held >> 8) * off.y);
    return mix(vec4(1.0), abs(predicted - w) / w, greaterThan(stored, vec4(0.0)));
}
