"""Lens part of an OpenTrackIO sample, with the distortion of OpenLensIO 1.0.1 (section 4.1).

The model is "Brown-Conrady D-U", which maps points of the picture to undistorted ones, in millimetres on the film. Its numerator
k1, k3, k5 is fitted to the lens's chief rays; its denominator k2, k4, k6 stays 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.camera import Camera
from render.optics.distortion import chief_rays

MODEL = "Brown-Conrady D-U"
FAR_AWAY_M = 100_000.0  # JSON has no infinity, and the protocol does not say yet how it is written
_SAMPLES = 200
_HOLDS = 0.01


@dataclass(frozen=True)
class TrackedDistortion:
    """A lens's distortion by three coefficients.

    Attributes:
        radial: k1 to k5 of OpenTrackIO: 1/mm², 0, 1/mm⁴, 0, 1/mm⁶.
        worst_mm: the most by which an undistorted point is off, on the film.
        holds: whether that is within 1 % of the corner's height; of a steep fisheye it is not.
    """

    radial: tuple[float, ...]
    worst_mm: float
    holds: bool = True


def tracked_distortion(camera: Camera) -> TrackedDistortion:
    """Fit OpenTrackIO's distortion to a camera's lens, up to the corner of its gate.

    Args:
        camera: the lens as it is set; an anamorphic lens as it is from top to bottom.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance.
    """
    chief = chief_rays(camera)
    if chief is None:
        return TrackedDistortion((0.0,), 0.0)
    corner = float(np.hypot(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)) / 2
    heights = np.linspace(corner / _SAMPLES, corner, _SAMPLES)
    slopes = np.stack([0 * heights, heights / camera.focal_length_mm], axis=1)
    undistorted = chief.undistort_slopes(slopes)[:, 1] * camera.focal_length_mm
    relative = heights / corner
    basis = np.stack([relative**3, relative**5, relative**7], axis=1)
    terms = np.linalg.lstsq(basis, undistorted - heights, rcond=None)[0]
    off = float(np.abs(basis @ terms - (undistorted - heights)).max())
    k1, k3, k5 = (float(term) / corner**power for term, power in zip(terms, (3, 5, 7), strict=True))
    return TrackedDistortion((k1, 0.0, k3, 0.0, k5), off, off <= _HOLDS * corner)
