"""Colour errors of a thin lens: from wavefronts between the C and the F line, as USD has them, to lengths between red and blue.

A wavefront ``W020·ρ²`` that is early at the edge of the pupil focuses short by ``8·N²·W020``, and a tilt
``W111·η·ρ·cos φ`` moves the image inward by ``2·N·W111`` (Welford 1986, sections 7.1 and 8.1). With the dispersion of
glass going as 1/λ², what lies between 650 and 475 nm is larger than what lies between the lines by a constant factor.
"""

from __future__ import annotations

from render.optics.glass import C_LINE_NM, D_LINE_NM, F_LINE_NM

_RED_NM, _BLUE_NM = 650.0, 475.0
_SPREAD = (_BLUE_NM**-2 - _RED_NM**-2) / (F_LINE_NM**-2 - C_LINE_NM**-2)
_WAVE_MM = D_LINE_NM * 1e-6


def axial_color_mm(waves: float, reference_f_stop: float) -> float:
    """Focus at 475 nm less focus at 650 nm, along the axis behind the lens.

    Args:
        waves: W020 at the F line less W020 at the C line, in wavelengths of the d line: positive focuses blue short.
        reference_f_stop: f-number at whose pupil's edge the wavefront error holds.
    """
    return -8 * reference_f_stop**2 * waves * _WAVE_MM * _SPREAD


def lateral_color_mm(waves: float, reference_f_stop: float) -> float:
    """Image height at 475 nm less that at 650 nm, at the reference height.

    Args:
        waves: W111 at the F line less W111 at the C line, in wavelengths of the d line: positive draws blue smaller.
        reference_f_stop: f-number at whose pupil's edge the wavefront error holds.
    """
    return -2 * reference_f_stop * waves * _WAVE_MM * _SPREAD
