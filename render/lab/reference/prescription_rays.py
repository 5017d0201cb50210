"""Rays through a prescription's glass: each is traced on its own, from its point of the film through its point of the stop."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from render.lab.reference.aiming import Aim, AimedLens, undone
from render.lab.reference.lens_tracer import TracedRays
from render.model.arrays import DoubleArray
from render.model.lens import HeightField, IrisShape
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.sampling import lens_samples

_NODES = (25, 19)  # film points across and down from which pixels guess how to aim
_ACCURATE = 1e-4  # of the stop's radius: how near to its point of the stop a ray has to pass
_CORRECTIONS = 3
_AXIS_RAYS = 256


@dataclass(frozen=True, eq=False)
class SceneRays:
    """Rays in object space.

    Attributes:
        offsets: ``(h, w, 2)`` where they pass the plane of the entrance pupil, metres to the right and up of its centre.
        slopes: ``(h, w, 2)`` metres to the right and up for a metre of depth; NaN for blocked rays, whose offsets mean nothing.
        weights: ``(h, w)`` light of each, over the mean on the axis; 0 for blocked rays.
    """

    offsets: DoubleArray
    slopes: DoubleArray
    weights: DoubleArray


@dataclass(frozen=True, eq=False)
class _Guesses:
    """Start values for aiming: rays from a coarse grid of film points, for every sample of the pupil.

    Attributes:
        across: ``(columns,)`` ideal slopes of the nodes.
        up: ``(rows,)`` the same upward.
        aims: ``(samples, rows, columns, 6)`` slope on the film's side, and the derivative of the stop point by it.
        open: ``(samples, rows, columns)`` whether such a ray was found and passes the lens.
    """

    across: DoubleArray
    up: DoubleArray
    aims: DoubleArray
    open: NDArray[np.bool_]

    def at(self, sample: int, ideal: DoubleArray) -> tuple[DoubleArray, NDArray[np.bool_]]:
        """``(h, w, 6)`` aims of a grid of pixels, and ``(h, w)`` whether any of the sixteen nodes around is open."""
        columns, rows = _cubic(self.across, ideal[0, :, 0]), _cubic(self.up, ideal[:, 0, 1])
        near = ((rows != 0).astype(float) @ self.open[sample] @ (columns != 0).astype(float).T) > 0
        return np.einsum("yr,rck,xc->yxk", rows, self.aims[sample], columns, optimize=True), np.asarray(near)


class PrescriptionRays:
    """A focused lens with the samples of its pupil.

    The weight of a ray is the projected solid angle that an element of the stop fills, seen from the film, over its mean on the
    axis at the d line: the law of cos⁴ is in it, and what the lens does to it.
    """

    has_colours = True

    def __init__(
        self, lens: FocusedLens, pupil: DoubleArray, corner: tuple[float, float], field: HeightField | None = None
    ) -> None:
        """Take the samples ``pupil`` ``(n, 2)``; ``corner`` is the largest ideal slope of any pixel, right and up."""
        self._lens, self._field, self._corner = lens, field, corner
        upright = np.sign(lens.first.entrance_pupil_magnification)
        self._stop_mm = upright * pupil * lens.stop_radius_mm
        self._aimed: dict[float, AimedLens] = {}
        self._guesses: dict[float, _Guesses] = {}
        self._axis_light = self._light_on_axis()

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        """See `render.lab.reference.lens_rays.LensRays`."""
        aimed = self._at(wavelength_nm)
        guess, reachable = self._guesses_at(wavelength_nm).at(sample, ideal)
        film = (-ideal * self._lens.image_scale_mm)[reachable]
        aim, rear = self._aimed_from(aimed, film, self._stop_mm[sample], guess[reachable])
        rays = [np.full((ideal[..., 0].size, size), fill) for size, fill in ((2, 0.0), (2, np.nan), (1, 0.0))]
        for whole, part in zip(rays, self._trace(aimed, aim, rear), strict=True):
            whole[np.flatnonzero(reachable)] = part
        offsets, out, light = (whole.reshape(*ideal.shape[:2], -1) for whole in rays)
        return SceneRays(offsets, out, light[..., 0] / self._axis_light)

    def _aimed_from(
        self, aimed: AimedLens, film: DoubleArray, stop: DoubleArray, guess: DoubleArray
    ) -> tuple[Aim, TracedRays]:
        """Aim rays at a point of the stop by guesses ``(n, 6)``; what stays wrong is sought from the axis."""
        slopes, jacobian = guess[:, :2].copy(), guess[:, 2:].reshape(-1, 2, 2).copy()
        for _ in range(_CORRECTIONS):
            rear = aimed.from_film(film, slopes)
            off = aimed.on_stop(rear) - stop
            wrong = ~(np.hypot(*off.T) <= _ACCURATE * self._lens.stop_radius_mm)
            if not wrong.any():
                return Aim(slopes, jacobian, ~wrong), rear
            slopes[wrong] -= undone(jacobian[wrong], off[wrong])
        again = aimed.aim(film[wrong], np.broadcast_to(stop, (int(wrong.sum()), 2)))
        slopes[wrong], jacobian[wrong] = again.slopes, again.jacobian
        solved = np.ones(len(film), bool)
        solved[wrong] = again.solved
        return Aim(slopes, jacobian, solved), aimed.from_film(film, slopes)

    def _trace(self, aimed: AimedLens, aim: Aim, rear: TracedRays) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """Offsets ``(n, 2)`` in metres, slopes ``(n, 2)`` and light ``(n, 1)`` of aimed rays in object space."""
        rays, passes = aimed.out(rear)
        depth_mm = self._lens.entrance_pupil_mm - rays.positions[:, 2]
        slopes = np.where((passes & aim.solved)[:, None], rays.directions[:, :2] / -rays.directions[:, 2:], np.nan)
        offsets = (rays.positions[:, :2] - slopes * depth_mm[:, None]) / 1000
        # direction cosines change with the slope m by (1 + m²)^-2, the stop point by the Jacobian's determinant
        with np.errstate(divide="ignore", invalid="ignore"):
            light = 1 / (np.square(1 + (aim.slopes**2).sum(1)) * np.abs(np.linalg.det(aim.jacobian)))[:, None]
        return offsets, slopes, np.where(np.isfinite(slopes[:, :1]), light, 0.0)

    def _light_on_axis(self) -> float:
        """Mean light of rays over a round iris, at the middle of the picture."""
        disc = lens_samples(_AXIS_RAYS, IrisShape(), tiled=False).disc[0] * self._lens.stop_radius_mm
        aimed, film = self._at(D_LINE_NM), np.zeros((_AXIS_RAYS, 2))
        aim = aimed.aim(film, disc)
        return float(self._trace(aimed, aim, aimed.from_film(film, aim.slopes))[2].mean())

    def _at(self, wavelength_nm: float) -> AimedLens:
        if wavelength_nm not in self._aimed:
            self._aimed[wavelength_nm] = AimedLens(self._lens, wavelength_nm, self._field)
        return self._aimed[wavelength_nm]

    def _guesses_at(self, wavelength_nm: float) -> _Guesses:
        if wavelength_nm not in self._guesses:
            across, up = (np.linspace(-end, end, count) for end, count in zip(self._corner, _NODES, strict=True))
            nodes = -np.stack(np.meshgrid(across, up), axis=-1).reshape(-1, 2) * self._lens.image_scale_mm
            samples, size = len(self._stop_mm), len(nodes)
            aimed, film = self._at(wavelength_nm), np.tile(nodes, (samples, 1))
            aim = aimed.aim(film, np.repeat(self._stop_mm, size, axis=0))
            open_ = aim.solved & aimed.out(aimed.from_film(film, aim.slopes))[1]
            aims = np.concatenate([aim.slopes, aim.jacobian.reshape(-1, 4)], axis=1)
            shape = (samples, len(up), len(across))
            aims = np.where(aim.solved[:, None], aims, 0.0).reshape(*shape, 6)
            self._guesses[wavelength_nm] = _Guesses(across, up, aims, open_.reshape(shape))
        return self._guesses[wavelength_nm]


def _cubic(nodes: DoubleArray, at: DoubleArray) -> DoubleArray:
    """``(len(at), len(nodes))`` weights of even nodes in the cubic through the four around each place (Lagrange)."""
    first = np.clip(((at - nodes[0]) / (nodes[1] - nodes[0])).astype(int) - 1, 0, len(nodes) - 4)
    t = (at - nodes[first]) / (nodes[1] - nodes[0])
    weights = np.zeros((len(at), len(nodes)))
    for i in range(4):
        others = [j for j in range(4) if j != i]
        weights[np.arange(len(at)), first + i] = np.prod([(t - j) / (i - j) for j in others], axis=0)
    return weights
