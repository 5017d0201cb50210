"""Ray tables: the only thing that the tracer knows of a lens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.optics.sampling import LensSamples, lens_samples
from render.optics.thin_lens import focus_w, pupil_radius_m
from render.scene import Camera, FloatArray


@dataclass(frozen=True, eq=False)
class RayBundle:
    """The rays of a lens, as the tracer's table.

    Attributes:
        table: ``(tiles, n, 8)`` float32: pupil point in units of the pupil's radius (x right, y down), offset on the sensor
            in pixels (x right, y down), weight, and three unused numbers that keep the table's alignment.
        pupil_radius_m: radius of the pupil in metres.
    """

    table: FloatArray
    pupil_radius_m: float

    @property
    def count(self) -> int:
        """Rays per pixel."""
        return int(self.table.shape[1])


@dataclass(frozen=True)
class FocalSurface:
    """Where a pixel is focused: ``w_f = w0 + slope_x·x + slope_y·y`` at picture position (x, y).

    Attributes:
        w0: inverse depth at the picture's top left corner, 1/m.
        slope_x: per pixel to the right; not 0 for a swung plane (Scheimpflug).
        slope_y: per pixel down; not 0 for a tilted plane.
    """

    w0: float
    slope_x: float = 0.0
    slope_y: float = 0.0


def thin_lens_bundle(camera: Camera, rays: int, *, seed: int = 0, tiled: bool = True) -> RayBundle:
    """Rays of the camera's thin lens; a pinhole has its rays through one point.

    Raises:
        SettingsError: rays, seed or the iris's shape is out of range.
    """
    return bundle_from_samples(lens_samples(rays, camera.iris, seed=seed, tiled=tiled), pupil_radius_m(camera))


def bundle_from_samples(samples: LensSamples, radius_m: float) -> RayBundle:
    """Table of equally weighted rays through the given samples."""
    table = np.zeros((*samples.pupil.shape[:2], 8), np.float32)
    table[..., 0] = samples.pupil[..., 0]
    table[..., 1] = -samples.pupil[..., 1]
    table[..., 2:4] = samples.pixel
    table[..., 4] = 1.0 / samples.count
    return RayBundle(table, radius_m)


def plane_of_focus(camera: Camera) -> FocalSurface:
    """The plane at the camera's focus distance."""
    return FocalSurface(focus_w(camera))
