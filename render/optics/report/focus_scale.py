"""Scale of the focus ring: travel and turn for each distance that makers engrave, and how the picture breathes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.errors import SettingsError
from render.model.camera import Camera
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.mounting import mount_lens
from render.optics.prescription.principal_rays import principal_rays

THROW_DEG = 270.0
"""Turn of the ring from infinity to the nearest mark."""
_METRES = (10.0, 5.0, 3.0, 2.0, 1.5, 1.2, 1.0, 0.8, 0.7, 0.6, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25)
_FEET = (30.0, 15.0, 10.0, 8.0, 6.0, 5.0, 4.0, 3.5, 3.0, 2.5, 2.0, 1.75, 1.5, 1.25, 1.0)
_FOOT_M = 0.3048
_NEAREST = 9.0  # focal lengths, of a lens that has no mark of its own
_ROUNDS = 6
_LIT = 0.7  # of the last height: where breathing is measured if the gate's edge is dark


@dataclass(frozen=True)
class FocusMark:
    """Mark on a focus ring.

    Attributes:
        distance_m: from the film; infinite for infinity.
        unit: ``m`` or ``ft``.
        travel_mm: farthest that a surface has moved from where it stands at infinity.
        turn_deg: of the ring, on a helicoid of even pitch that turns by `THROW_DEG` to the nearest mark.
        breathing: growth of the picture since infinity: 0.02 shows a fiftieth less.
    """

    distance_m: float
    unit: str
    travel_mm: float
    turn_deg: float
    breathing: float

    @property
    def label(self) -> str:
        """The mark as it is engraved."""
        if not np.isfinite(self.distance_m):
            return "∞"
        return f"{self.distance_m / (_FOOT_M if self.unit == 'ft' else 1.0):.3g}"


def focus_scale(camera: Camera) -> tuple[FocusMark, ...]:
    """Marks of a camera's lens with surfaces, in metres from infinity inward, then in feet; none where infinity is out of reach.

    Args:
        camera: with its lens and gate; its focus distance does not matter.
    """
    try:
        far = mount_lens(replace(camera, focus_distance_m=float("inf")))
    except SettingsError:
        return ()
    nearest = camera.lens.close_focus_m or _NEAREST * camera.focal_length_mm / 1000
    wanted = [(m, "m") for m in (np.inf, *_METRES)] + [(ft * _FOOT_M, "ft") for ft in (np.inf, *_FEET)]
    wanted = [(m, unit) for m, unit in wanted if m >= nearest * 0.999]
    if camera.lens.close_focus_m:
        metres = [mark for mark in wanted if mark[1] == "m"]
        if abs(metres[-1][0] - nearest) > 0.01 * nearest:
            wanted.insert(len(metres), (nearest, "m"))
    edge_mm = min(camera.horizontal_aperture_mm / 2 / camera.lens.squeeze, _LIT * principal_rays(far).last_height_mm)
    seen = _seen(far, edge_mm)
    found = []
    for distance_m, unit in wanted:
        lens = far if np.isinf(distance_m) else _focused(camera, distance_m)
        if lens is not None:
            travel = float(np.abs(lens.vertices_mm - far.vertices_mm).max())
            found.append(FocusMark(float(distance_m), unit, travel, 0.0, seen / _seen(lens, edge_mm) - 1))
    longest = max((mark.travel_mm for mark in found), default=0.0)
    return tuple(replace(mark, turn_deg=THROW_DEG * mark.travel_mm / longest if longest else 0.0) for mark in found)


def _focused(camera: Camera, from_film_m: float) -> FocusedLens | None:
    """The lens focused at a distance from the film; None where it does not reach so near."""
    lens, distance_m = None, from_film_m
    for _ in range(_ROUNDS):
        try:
            lens = mount_lens(replace(camera, focus_distance_m=distance_m))
        except SettingsError:
            return None
        left_m = from_film_m - (lens.film_mm - lens.entrance_pupil_mm) / 1000
        if left_m <= 0:
            return None
        if abs(left_m - distance_m) < 1e-5 * from_film_m:
            break
        distance_m = left_m
    return lens


def _seen(lens: FocusedLens, height_mm: float) -> float:
    """Slope in object space that is seen at a height of the picture."""
    return float(principal_rays(lens).at(np.array([height_mm]), 0.0)[0][0])
