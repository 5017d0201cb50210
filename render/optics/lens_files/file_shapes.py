"""Shapes of surfaces as files have them, as the model has them: a conic, and terms from r³ to r²⁰.

Odd and even powers and Qcon are the model's own, to the last digit. A term of r² on a curved surface, Qbfs, and even powers
beyond r²⁰ are not: they are fitted by a conic of the same curvature at the vertex and even powers, within a fiftieth of a
wavelength, and refused where that is not enough.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.polynomial import Chebyshev, Polynomial

from render.model.arrays import DoubleArray
from render.model.lens import Across
from render.optics.lens_files.draft_surface import DraftSurface
from render.optics.lens_files.forbes import ForbesTerms, qcon_terms
from render.optics.lens_files.lens_text import LensText

_PLANE_RADIUS_MM, _LEAST_RADIUS_MM = 1e9, 1e-3
_HIGHEST_POWER = 20
_FITTED_TERMS = 9  # r⁴ to r²⁰
_WORST_MM, _WORST_SLOPE = 1e-5, 1e-5
_EDGE_OF_CONIC = 1 - 1e-6
_NORMALISATION_MM = 1e-3, 1e5


@dataclass(frozen=True)
class FileShape:
    """Shape of a surface in millimetres.

    Attributes:
        radius_mm: 0 is a plane.
        conic: conic constant.
        aspheric: coefficients of r⁴, r⁶, ...
        odd: coefficients of r³, r⁵, ...
        note: on an approximation; "" where there is none.
        across: curve from side to side; None where it is that from top to bottom.
    """

    radius_mm: float
    conic: float
    aspheric: tuple[float, ...]
    odd: tuple[float, ...]
    note: str = ""
    across: Across | None = None


def shape_in_mm(surface: DraftSurface, unit_mm: float, text: LensText) -> FileShape:
    """The shape of a surface as it was read. Of a torus, the curve that is turned has all that a surface of revolution can have.

    Args:
        surface: as its file has it.
        unit_mm: the file's unit of length.
        text: the file, for messages.

    Raises:
        InputError: the model has no such shape; the message names the surface.
    """
    if surface.across is None:
        return _round_shape(surface, unit_mm, text)
    radius, conic = surface.across
    if surface.torus != "across":
        shape = _round_shape(surface, unit_mm, text)
        return replace(shape, across=_curve(shape, radius * unit_mm, conic, surface.torus))
    lying = _round_shape(replace(surface, radius=radius, conic=conic), unit_mm, text)
    standing = replace(lying, radius_mm=surface.radius * unit_mm, conic=surface.conic)
    return replace(standing, across=_curve(standing, lying.radius_mm, lying.conic, surface.torus))


def _curve(shape: FileShape, radius_mm: float, conic: float, torus: Literal["", "upright", "across"]) -> Across | None:
    """The curve from side to side; a torus without terms that is straight one way is a cylinder, which a biconic is too."""
    if torus and not (shape.aspheric or shape.odd):
        is_sphere = radius_mm == shape.radius_mm and not (conic or shape.conic)
        torus = torus if radius_mm and shape.radius_mm and not is_sphere else ""
    curve = Across(radius_mm, conic, torus)
    return None if curve == Across(shape.radius_mm, shape.conic) else curve


def _round_shape(surface: DraftSurface, unit_mm: float, text: LensText) -> FileShape:
    # sag/unit = a·(r/unit)^p, so a grows by unit^(1 − p)
    terms = {power: value * unit_mm ** (1 - power) for power, value in surface.terms.items() if value != 0}
    radius, conic, forbes = surface.radius * unit_mm, surface.conic, surface.forbes and surface.forbes.scaled(unit_mm)
    _check_radius(radius, surface, text)
    if 1 in terms:
        what = "a term of r^1 is not supported: it makes a cone, whose tip has no focal length"
        raise text.error(what, surface.line, surface.label)
    low, high = _NORMALISATION_MM
    if forbes is not None and not low <= forbes.radius <= high:
        what = f"the normalisation radius must be from {low:g} to {high:g} mm, got {forbes.radius:g} mm"
        raise text.error(what, surface.line, surface.label)
    if forbes is not None and forbes.kind == "Qbfs" and conic:
        what = f"Qbfs terms depart from a sphere: the conic constant must be 0, got {conic:g}"
        raise text.error(what, surface.line, surface.label)
    if odd := [power for power in terms if power % 2 and power > _HIGHEST_POWER]:
        what = f"terms of odd powers are supported up to r^{_HIGHEST_POWER - 1}, got r^{max(odd)}"
        raise text.error(what, surface.line, surface.label)
    if forbes is not None and forbes.kind == "Qcon" and len(forbes.coefficients) <= _FITTED_TERMS:
        for power, value in qcon_terms(forbes).items():
            terms[power] = terms.get(power, 0.0) + value
        forbes = None
    if radius == 0 and terms.get(2) and forbes is None:
        radius, conic = 0.5 / terms.pop(2), -1.0  # a·r² is the paraboloid of that radius
    note = ""
    reason = _reason(terms, forbes)
    if reason and surface.across is not None and not surface.torus:
        raise text.error(f"its {reason} are not supported beside two curves", surface.line, surface.label)
    if reason:
        width = surface.semi_diameter * unit_mm or (forbes.radius if forbes is not None else 0.0)
        if width:
            with np.errstate(all="ignore"):
                fit = _Fit(radius, conic, terms, forbes, width)
            if fit.worst_mm > _WORST_MM or fit.worst_slope > _WORST_SLOPE or not np.isfinite(fit.worst_mm):
                what = f"its {reason} cannot be told by a conic and even powers up to r^{_HIGHEST_POWER}"
                raise text.error(f"{what}: the best of them is {fit.worst_mm:.2g} mm off", surface.line, surface.label)
            radius, conic, terms = fit.radius_mm, fit.conic, fit.terms
            note = (
                f"Surface {surface.label} is a conic with even powers up to r^{_HIGHEST_POWER} in place of its {reason}:"
                f" within {max(fit.worst_mm * 1e6, 0.001):.2g} nm out to {fit.width_mm:.4g} mm from the axis."
            )
        elif 2 in terms:
            what = "a term of r^2 is supported on a surface without curvature or with a clear diameter alone"
            raise text.error(what, surface.line, surface.label)
    _check_radius(radius, surface, text)
    if abs(radius) > _PLANE_RADIUS_MM:
        radius = 0.0
    return FileShape(radius, conic, _from(terms, 4), _from(terms, 3), note)


def _check_radius(radius_mm: float, surface: DraftSurface, text: LensText) -> None:
    if 0 < abs(radius_mm) < _LEAST_RADIUS_MM:
        what = f"the radius must be 0 or at least {_LEAST_RADIUS_MM:g} mm, got {radius_mm:g} mm"
        raise text.error(what, surface.line, surface.label)


def _reason(terms: dict[int, float], forbes: ForbesTerms | None) -> str:
    """The part of the shape that the model does not have; "" where it has all."""
    parts = [f"{forbes.kind} terms"] if forbes is not None else []
    parts += ["term of r^2"] if 2 in terms else []
    parts += [f"terms beyond r^{_HIGHEST_POWER}"] if max(terms, default=0) > _HIGHEST_POWER else []
    return " and ".join(parts)


def _from(terms: dict[int, float], first: int) -> tuple[float, ...]:
    """Coefficients of every other power from the first on."""
    last = max((power for power in terms if power % 2 == first % 2 and terms[power]), default=0)
    return tuple(terms.get(power, 0.0) for power in range(first, last + 1, 2))


class _Fit:
    """A conic with the curvature at the vertex, and even powers, fitted by least squares out to a distance from the axis.

    The conic ends where the surface's does, so that the remainder is smooth up to the edge.
    """

    def __init__(
        self, radius_mm: float, conic: float, terms: dict[int, float], forbes: ForbesTerms | None, width_mm: float
    ) -> None:
        self._curvature = 1 / radius_mm if radius_mm else 0.0
        self._bend = (1 + conic) * self._curvature**2
        self._own_terms, self._forbes = terms, forbes
        vertex = self._curvature + 2 * terms.get(2, 0.0) + (forbes.added_curvature() if forbes is not None else 0.0)
        self.radius_mm = 1 / vertex if abs(vertex) > 1 / _PLANE_RADIUS_MM else 0.0
        self._vertex = 1 / self.radius_mm if self.radius_mm else 0.0
        self.conic = self._bend / (self._vertex * self._vertex) - 1 if self._vertex else 0.0
        end = _EDGE_OF_CONIC / np.sqrt(self._bend) if self._bend > 0 else np.inf
        self.width_mm = float(min(width_mm, end))
        fitted = self._fitted()
        kept = {power: value for power, value in terms.items() if 2 < power <= _HIGHEST_POWER}
        self.terms = kept | {power: kept.get(power, 0.0) + value for power, value in fitted.items()}
        radii = np.linspace(0, self.width_mm, 4001)
        miss = self._remainder(radii**2) - sum(value * radii**power for power, value in fitted.items())
        self.worst_mm = float(np.abs(miss).max())
        self.worst_slope = float(np.abs(np.gradient(miss, radii)).max())

    def _remainder(self, r2: DoubleArray) -> DoubleArray:
        """Sag beyond the new conic, without the terms that are kept."""
        root = np.sqrt(np.maximum(1 - self._bend * r2, 0))
        own_root = root if self._vertex else 1.0
        rest = self._curvature * r2 / (1 + root) - self._vertex * r2 / (1 + own_root)
        for power, value in self._own_terms.items():
            if power == 2 or power > _HIGHEST_POWER:
                rest = rest + value * r2 ** (power // 2)
        return np.asarray(rest if self._forbes is None else rest + self._forbes.departure(r2, self._curvature))

    def _fitted(self) -> dict[int, float]:
        """Coefficients by their power: t²·Σ b_k·T_k(2t − 1) for t the square of the distance over the widest."""
        t = (1 - np.cos(np.pi * (np.arange(400) + 0.5) / 400)) / 2
        basis = t[:, None] ** 2 * np.polynomial.chebyshev.chebvander(2 * t - 1, _FITTED_TERMS - 1)
        rest = self._remainder(t * self.width_mm**2)
        if not np.isfinite(rest).all():
            return {}
        found, *_ = np.linalg.lstsq(basis, rest, rcond=None)
        powers = Chebyshev(found, domain=[0, 1]).convert(kind=Polynomial).coef
        return {4 + 2 * i: float(value) / self.width_mm ** (4 + 2 * i) for i, value in enumerate(powers)}
