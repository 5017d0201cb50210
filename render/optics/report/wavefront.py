"""The wavefront that converges on a place of the film, as polynomials over direction cosines, and what it resolves.

A pupil point is a pair of direction cosines p = (l, m) on the film. Errors W are lengths of optical path; a ray lands beside the
place by the gradient of W (Welford 1986, ch. 7), and of two points that are λν apart on the pupil the mean of exp(ik·ΔW) is the
optical transfer function at the frequency ν (Hopkins 1955; Goodman 2005, section 6.3): the autocorrelation of the pupil.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from render.model.arrays import DoubleArray
from render.optics.report.film_cone import FilmCone

_DEGREE = 13
_RIDGE = 1e-14
_FEWEST = 40  # open cells for a fit


@dataclass(frozen=True, eq=False)
class Wavefront:
    """A wavefront over the square around its pupil.

    Attributes:
        middle: ``(2,)`` of the square, direction cosines l (across) and m (away from the picture's middle).
        half: ``(2,)`` its half sides.
        terms: ``(degree + 1, degree + 1)`` Legendre coefficients of W in mm, of m and l.
        cover: ``(side, side)`` share of each cell that is open, rows of m.
        wavelength_nm: of the light.
        fit_error_nm: root-mean-square error of the polynomials.
    """

    middle: DoubleArray
    half: DoubleArray
    terms: DoubleArray
    cover: DoubleArray
    wavelength_nm: float
    fit_error_nm: float = 0.0

    @property
    def light(self) -> float:
        """Projected solid angle of the pupil."""
        return float(self.cover.mean() * 4 * self.half.prod())

    def diffraction(self, shifts_mm: DoubleArray, frequency: float, axis: int) -> DoubleArray:
        """Complex optical transfer function ``(z,)`` with diffraction.

        Args:
            shifts_mm: ``(z,)`` by which the film stands behind its place.
            frequency: line pairs per mm.
            axis: 0 varies across (lines along the radius), 1 along the radius.
        """
        step = np.zeros(2)
        step[axis] = self.wavelength_nm * 1e-6 * frequency / 2
        ends = [self._lines(sign * step) for sign in (1.0, -1.0)]
        weight = self._cover_at(*ends[0]) * self._cover_at(*ends[1])
        path = self._path(*ends[0]) - self._path(*ends[1])
        defocus = _along(*ends[0]) - _along(*ends[1])
        return self._mean(path, defocus, weight, self._wave_number, shifts_mm)

    def geometric(self, shifts_mm: DoubleArray, frequency: float, axis: int) -> DoubleArray:
        """Complex optical transfer function ``(z,)`` of the rays alone; arguments as of `diffraction`."""
        lines = self._lines(np.zeros(2))
        slopes = legendre.legder(self.terms, axis=1 - axis) / self.half[axis]
        landing = self._evaluate(slopes, *lines)
        defocus = -(lines[0][None, :] if axis == 0 else lines[1][:, None]) / _along(*lines)
        return self._mean(landing, defocus, self.cover, 2 * np.pi * frequency, shifts_mm)

    @property
    def _wave_number(self) -> float:
        """Per mm."""
        return 2 * np.pi / (self.wavelength_nm * 1e-6)

    def _lines(self, step: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """The columns' l and the rows' m, moved by a step."""
        side = len(self.cover)
        line = (np.arange(side) + 0.5) / side * 2 - 1
        return self.middle[0] + self.half[0] * line + step[0], self.middle[1] + self.half[1] * line + step[1]

    def _path(self, across: DoubleArray, up: DoubleArray) -> DoubleArray:
        return self._evaluate(self.terms, across, up)

    def _evaluate(self, terms: DoubleArray, across: DoubleArray, up: DoubleArray) -> DoubleArray:
        x, y = (across - self.middle[0]) / self.half[0], (up - self.middle[1]) / self.half[1]
        return np.asarray(
            legendre.legvander(y, terms.shape[0] - 1) @ terms @ legendre.legvander(x, terms.shape[1] - 1).T
        )

    def _cover_at(self, across: DoubleArray, up: DoubleArray) -> DoubleArray:
        """Cover between the cells' centres, bilinear."""
        side = len(self.cover)
        rows, columns = (
            _linear((line - middle) / half, side)
            for line, middle, half in ((up, self.middle[1], self.half[1]), (across, self.middle[0], self.half[0]))
        )
        return np.asarray(rows @ self.cover @ columns.T)

    def _mean(
        self, path: DoubleArray, defocus: DoubleArray, weight: DoubleArray, scale: float, shifts_mm: DoubleArray
    ) -> DoubleArray:
        is_open = weight > 0
        phase = np.exp(1j * scale * path[is_open])
        turned = np.exp(1j * scale * np.multiply.outer(np.asarray(shifts_mm), defocus[is_open]))
        return np.asarray(turned @ (weight[is_open] * phase) / self.cover.sum())


def fit_wavefront(cone: FilmCone, path_mm: DoubleArray, wavelength_nm: float) -> Wavefront | None:
    """Fit polynomials through the optical paths of a cone of rays.

    Args:
        cone: rays of a place on the film.
        path_mm: ``(n,)`` from the object through each of them.
        wavelength_nm: of the light.

    Returns:
        None where too few rays pass.
    """
    known = (cone.cover > 0) & np.isfinite(path_mm)
    if known.sum() < _FEWEST:
        return None
    side = cone.side
    low, high = cone.cosines[0], cone.cosines[-1]
    middle, half = (low + high) / 2, (high - low) / 2 * side / (side - 1)
    at = (cone.cosines[known] - middle) / half
    reach = int(np.clip(np.sqrt(known.sum()) / 3, 3, _DEGREE))
    powers = [(i, j) for i in range(reach + 1) for j in range(0, reach + 1 - i, 2)]  # even across
    up, across = legendre.legvander(at[:, 1], reach), legendre.legvander(at[:, 0], reach)
    basis = np.stack([up[:, i] * across[:, j] for i, j in powers], axis=1)
    wanted = path_mm[known] - path_mm[known].mean()
    found = _least_squares(basis, wanted)
    terms = np.zeros((reach + 1, reach + 1))
    for (i, j), value in zip(powers, found, strict=True):
        terms[i, j] = value
    error_nm = 1e6 * float(np.sqrt(np.mean((basis @ found - wanted) ** 2)))
    return Wavefront(middle, half, terms, cone.cover.reshape(side, side), wavelength_nm, error_nm)


def _least_squares(basis: DoubleArray, values: DoubleArray) -> DoubleArray:
    """Coefficients by the normal equations, corrected once; many times as fast as by singular values."""
    normal = basis.T @ basis
    normal += _RIDGE * np.trace(normal) * np.eye(len(normal))
    found = np.linalg.solve(normal, basis.T @ values)
    return np.asarray(found + np.linalg.solve(normal, basis.T @ (values - basis @ found)))


def _along(across: DoubleArray, up: DoubleArray) -> DoubleArray:
    """Third direction cosine."""
    return np.asarray(np.sqrt(np.maximum(1 - across[None, :] ** 2 - up[:, None] ** 2, 1e-9)))


def _linear(at: DoubleArray, side: int) -> DoubleArray:
    """``(n, side)`` weights of cells for places from -1 to 1; 0 beyond."""
    place = (at + 1) / 2 * side - 0.5
    return np.asarray(np.maximum(0.0, 1 - np.abs(place[:, None] - np.arange(side))))
