"""Chief rays of a lens by Pullfocus's tracer, from the middle of the stop both ways, and the foci of pencils about them."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from render.model.arrays import DoubleArray
from render.optics.glass import D_LINE_NM
from render.optics.prescription.paraxial import vertices
from render.optics.prescription.tracing import TracedRays, trace_backward, trace_forward
from tests.render.optics.corpus.lenses import CorpusLens

_NARROW_MM = 1e-3
_AHEAD_MM = 30.0
_STEEPEST_RAD = math.radians(70)  # at the stop


class ChiefRay:
    """The chief ray of a field."""

    def __init__(self, lens: CorpusLens, angle_deg: float, wavelength_nm: float = D_LINE_NM) -> None:
        """Find the ray that goes through the middle of the stop and comes from that angle to the axis."""
        self._lens, self._nm = lens, wavelength_nm
        self._angle = math.radians(angle_deg)
        ends = self._first_change(np.linspace(0.0, _STEEPEST_RAD, 281))
        self._at_stop = float(brentq(lambda at_stop: self._seen(at_stop) - self._angle, *ends, xtol=1e-15, rtol=1e-14))

    def height_mm(self) -> float:
        """Height on the film where it is sharp close to the axis at the d line; positive is the upright picture's."""
        count = len(self._lens.prescription.surfaces)
        return float(self._trace(self._at_stop, forward=True, between=(self._split, count)).at(self._film_mm)[0, 1])

    def passes(self) -> bool:
        """Whether no rim blocks it."""
        return bool(self._from_the_scene(np.zeros((1, 3)), clip=True).passes[0])

    def foci_mm(self) -> tuple[float, float]:
        """Sagittal and tangential focus behind the film."""
        front = self._trace(self._at_stop, forward=False, between=(0, self._split))
        x, y, z = front.points_mm[-1][0]
        direction = np.array([0.0, math.sin(self._angle), math.cos(self._angle)])
        start = np.array([x, y, z]) - 30 * direction
        beside = np.array([[_NARROW_MM, 0, 0], [0, _NARROW_MM, 0], [0, -_NARROW_MM, 0]])
        traced = trace_forward(
            self._lens.prescription, start + beside, np.tile(direction, (3, 1)), self._nm, clip=False
        )
        on_film, slopes = traced.at(self._film_mm), traced.directions[:, :2] / traced.directions[:, 2:]
        sagittal = -on_film[0, 0] / slopes[0, 0]
        tangential = -(on_film[1, 1] - on_film[2, 1]) / (slopes[1, 1] - slopes[2, 1])
        return float(sagittal), float(tangential)

    def _from_the_scene(self, beside_mm: DoubleArray, *, clip: bool) -> TracedRays:
        """Trace rays that are parallel to it, ``(n, 3)`` mm beside it."""
        front = self._trace(self._at_stop, forward=False, between=(0, self._split)).points_mm[-1][0]
        direction = np.array([0.0, math.sin(self._angle), math.cos(self._angle)])
        start, directions = front - _AHEAD_MM * direction + beside_mm, np.tile(direction, (len(beside_mm), 1))
        return trace_forward(self._lens.prescription, start, directions, self._nm, clip=clip)

    @property
    def _film_mm(self) -> float:
        return self._lens.first.length_mm + self._lens.first.back_focal_mm

    @property
    def _split(self) -> int:
        return self._lens.stop + 1

    def _trace(self, at_stop: float, *, forward: bool, between: tuple[int, int]) -> TracedRays:
        glass = self._lens.prescription
        point = np.array([[0.0, 0.0, float(vertices(glass)[self._lens.stop])]])
        sign = 1.0 if forward else -1.0
        direction = sign * np.array([[0.0, math.sin(at_stop), math.cos(at_stop)]])
        trace = trace_forward if forward else trace_backward
        return trace(glass, point, direction, self._nm, clip=False, between=between)

    def _seen(self, at_stop: float) -> float:
        """Angle in object space of the ray that crosses the stop at an angle; NaN where it is lost."""
        direction = self._trace(at_stop, forward=False, between=(0, self._split)).directions[0]
        return math.atan2(-direction[1], -direction[2])

    def _first_change(self, angles: DoubleArray) -> tuple[float, float]:
        before = 0.0
        for angle in angles[1:]:
            if self._seen(float(angle)) >= self._angle:
                return before, float(angle)
            before = float(angle)
        raise AssertionError(f"{self._lens.name} has no chief ray at {math.degrees(self._angle):.1f}°")
