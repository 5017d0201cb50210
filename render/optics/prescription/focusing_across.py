"""Focusing of an anamorphic lens from side to side, by cylinders that move on their own.

A lens with cylinders before a spherical one is sharp from top to bottom by the spherical one's focus. From side to side the
cylinders magnify, and with the magnification the place of the image changes: cylinders that stand still are sharp from side to
side at infinity alone. Attachments that are focused twice change the distance between negative and positive cylinder as well.
Since the cylinders have no power from top to bottom, the focus there stays; the squeeze does not: it falls as the focus comes
nearer.

Places are z in millimetres as in `render.optics.prescription.focusing`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.errors import SettingsError
from render.model.arrays import DoubleArray
from render.model.lens import Prescription
from render.optics.prescription.beams import best_focus_mm
from render.optics.prescription.focus_mechanism import FocusMechanism
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import transfer

_PLACES = 257
_BISECTIONS = 60
_ROUNDS = 20
_SETTLED_MM = 1e-9


@dataclass(frozen=True, eq=False)
class FocusAcross:
    """Mechanism that focuses a lens from side to side.

    Attributes:
        mechanism: of the lens turned by a quarter, sharp from top to bottom, with the cylinders as its moving glass.
        object_mm: z of what is in focus, 0 at the front vertex before the cylinders move; minus infinity is infinity.
    """

    mechanism: FocusMechanism
    object_mm: float

    @classmethod
    def of_lens(cls, focused: Prescription, object_mm: float) -> FocusAcross:
        """Mechanism of a lens with ``focus_group_across``, its thicknesses as focused from top to bottom."""
        sideways = replace(turned(focused), focus_group=focused.focus_group_across)
        return cls(FocusMechanism.from_prescription(sideways), object_mm)

    def paraxial_shift(self) -> float:
        """Shift of the cylinders that makes the object sharp from side to side to first order, the smallest one.

        Raises:
            SettingsError: they do not move so far.
        """
        low, high = self.mechanism.travel()
        shifts = np.unique(np.append(np.linspace(low, high, _PLACES), 0.0))
        misses = np.array([self._miss(float(shift)) for shift in shifts])
        crossings = np.flatnonzero(misses[:-1] * misses[1:] <= 0)
        if not len(crossings):
            name = self.mechanism.prescription.name or "the lens"
            what = f"its cylinders move by {low:.4g} to {high:.4g} mm, and nowhere there is it sharp from side to side"
            away = f"{-0.001 * self.object_mm:.4g} m before its front" if np.isfinite(self.object_mm) else "infinity"
            raise SettingsError(f"{name} cannot focus at {away}: {what}", code="focus_out_of_reach")
        nearest = min(crossings, key=lambda i: float(min(abs(shifts[i]), abs(shifts[i + 1]))))
        start, end = float(shifts[nearest]), float(shifts[nearest + 1])
        sign = np.sign(misses[nearest])
        for _ in range(_BISECTIONS):
            middle = (start + end) / 2
            start, end = (middle, end) if np.sign(self._miss(middle)) == sign else (start, middle)
        return (start + end) / 2

    def spot_shift(self, shift_mm: float, stop_radius_mm: float) -> float:
        """Shift that brings the narrowest image from side to side onto the film, by secants from the paraxial shift."""
        low, high = self.mechanism.travel()
        previous, shift = shift_mm + 1e-3, shift_mm
        miss_before, miss = (self._spot_miss(at, stop_radius_mm) for at in (previous, shift))
        for _ in range(_ROUNDS):
            if abs(miss) < _SETTLED_MM or miss == miss_before:
                break
            step = miss * (shift - previous) / (miss - miss_before)
            previous, miss_before, shift = shift, miss, float(np.clip(shift - step, low, high))
            miss = self._spot_miss(shift, stop_radius_mm)
        return shift

    def vertices_mm(self, shift_mm: float) -> DoubleArray:
        """z of the vertices ``(n,)`` with the cylinders moved."""
        return self.mechanism.shifted_vertices(shift_mm)

    def _miss(self, shift_mm: float) -> float:
        """Spread on the film of a point's rays over that on the front vertex's plane."""
        moved = self.vertices_mm(shift_mm)
        system = replace(self.mechanism.system, vertices_mm=moved)
        (lift, scale), _ = transfer(system, 0, len(moved), to_mm=self.mechanism.film_mm)
        return lift + scale / (float(moved[0]) - self.object_mm)

    def _spot_miss(self, shift_mm: float, stop_radius_mm: float) -> float:
        glass, moved = self.mechanism.prescription, self.vertices_mm(shift_mm)
        return best_focus_mm(glass, self.object_mm, stop_radius_mm, moved) - self.mechanism.film_mm
