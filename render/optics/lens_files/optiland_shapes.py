"""Shapes of surfaces in optiland's files.

    Plane, StandardGeometry           radius and conic
    EvenAsphere, OddAsphere           coefficients of r², r⁴, ... and of r, r², ...
    ToroidalGeometry                  radius_yz, conic_yz and coeffs_poly_y of y², y⁴, ... turned at radius_rotation
    ChebyshevPolynomialGeometry       coefficients[i][j] of T_i(x/norm_x)·T_j(y/norm_y), beyond the conic

Chebyshev polynomials are read where they have rotational symmetry within a nanometre's millionth, as even powers of r, and
refused where they have not.
"""

from __future__ import annotations

import math

import numpy as np

from render.optics.lens_files.chebyshev import MOST_ORDERS, SAME_MM, round_part
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.json_text import JsonPart

_POWERS = {
    "Plane": 0,
    "StandardGeometry": 0,
    "EvenAsphere": 2,
    "OddAsphere": 1,
}  # step of the terms' powers; 0 for none
_TORUS = "ToroidalGeometry"
_CHEBYSHEV = "ChebyshevPolynomialGeometry"
_MOST_COEFFICIENTS = 40
_LEAST_LENGTH_MM = 1e-3
_WITHIN = 1 + 1e-9

TYPES = (*_POWERS, _TORUS, _CHEBYSHEV)


def set_shape(geometry: JsonPart, surface: DraftSurface) -> float:
    """Set the shape of a surface.

    Args:
        geometry: whose type is one of `TYPES`.
        surface: with its clear diameter, if that is known.

    Returns:
        Distance by which its vertex stands behind its place.

    Raises:
        InputError: it is not of the format, or a shape that is not supported.
    """
    kind = geometry.word("type")
    if kind == "Plane":
        return 0.0
    if kind == _TORUS:
        surface.radius, surface.conic = _radius(geometry, "radius_yz"), geometry.number("conic_yz", 0.0)
        surface.across, surface.torus = (_radius(geometry, "radius_rotation"), 0.0), "upright"
        values = geometry.numbers("coeffs_poly_y", at_most=_MOST_COEFFICIENTS)
        surface.terms = {2 * (i + 1): value for i, value in enumerate(values) if value}
        return 0.0
    surface.radius = _radius(geometry, "radius")
    surface.conic = geometry.number("conic", 0.0)
    if kind == _CHEBYSHEV:
        return _set_chebyshev(geometry, surface)
    step = _POWERS[kind]
    values = geometry.numbers("coefficients", at_most=_MOST_COEFFICIENTS) if step else []
    surface.terms = {step * (i + 1): value for i, value in enumerate(values) if value}
    return 0.0


def _radius(geometry: JsonPart, name: str) -> float:
    radius = geometry.number(name, math.inf, infinite=True)
    return 0.0 if math.isinf(radius) else radius


def _set_chebyshev(geometry: JsonPart, surface: DraftSurface) -> float:
    coefficients = np.array(geometry.rows("coefficients", at_most=MOST_ORDERS))
    if not coefficients.any():
        return 0.0
    lengths = [geometry.number(name, 1.0) for name in ("norm_x", "norm_y")]
    if not min(lengths) >= _LEAST_LENGTH_MM:
        what = f"norm_x and norm_y must be at least {_LEAST_LENGTH_MM:g}, got {lengths[0]:g} and {lengths[1]:g}"
        raise geometry.error(what, surface.label)
    reach = min(lengths)
    if surface.semi_diameter > reach * _WITHIN:
        what = f"its clear semi-diameter of {surface.semi_diameter:g} exceeds norm_x or norm_y, to which its shape is known"
        raise geometry.error(what, surface.label)
    surface.semi_diameter = surface.semi_diameter or reach  # it is not defined beyond
    with np.errstate(over="ignore", invalid="ignore"):
        part = round_part(coefficients, lengths, surface.semi_diameter)
    if not part.left_over <= SAME_MM:
        what = "Chebyshev polynomials without rotational symmetry are not supported"
        raise geometry.error(f"{what}: these depart from it by {part.left_over:.2g} mm", surface.label)
    surface.terms = part.terms
    return part.vertex
