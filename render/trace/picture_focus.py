"""Focus of a picture's pixels: the camera's focal surface through its lens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.focus.surface import focused_at
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.focal_surface import FocalSurface
from render.optics.distortion import ChiefRays, chief_rays
from render.optics.thin_lens import focal_surface
from render.optics.view import PinholeView

_GRID = 33


@dataclass(frozen=True, eq=False)
class PictureFocus:
    """A focal surface in a picture.

    Attributes:
        surface: focal surface over slopes of object space.
        view: view of the picture.
        chief: the lens's chief rays; None where they are straight.
    """

    surface: FocalSurface
    view: PinholeView
    chief: ChiefRays | None = None

    @property
    def affine(self) -> tuple[float, float, float] | None:
        """Coefficients of an affine w_f: at the picture's top left corner, and per pixel right and down; None if it is
        not affine.
        """
        plane = self.surface.plane
        if not self.surface.is_plane or (self.chief is not None and not plane.is_upright):
            return None
        return self.view.across(plane)

    def at(self, places_px: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """w_f ``(...)`` from the view's base in 1/m, and relative pupil radius ``(...)``, at positions ``(..., 2)`` in pixels."""
        slopes = (places_px - [self.view.cx, self.view.cy]) / [self.view.fx, self.view.fy]
        seen = slopes if self.chief is None else self.chief.undistort_slopes(slopes)
        return self._focused_at(seen * [1.0, -1.0])

    def over_picture(self) -> tuple[DoubleArray, DoubleArray]:
        """`at` on a grid over the picture, and at the control points."""
        x, y = np.meshgrid(np.linspace(0, self.view.width, _GRID), np.linspace(0, self.view.height, _GRID))
        w, pupil = self.at(np.stack([x, y], axis=-1).reshape(-1, 2))
        if self.surface.controls is None:
            return w, pupil
        more_w, more_pupil = self._focused_at(self.surface.controls.places)
        return np.concatenate([w, more_w]), np.concatenate([pupil, more_pupil])

    def _focused_at(self, slopes: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        w, pupil = focused_at(self.surface, slopes)
        return w - self.view.base_w, pupil


def picture_focus(camera: Camera, view: PinholeView) -> PictureFocus:
    """The camera's focal surface, or the upright plane at its focus distance, in a picture of it."""
    surface = focal_surface(camera)
    straight = surface.is_plane and surface.plane.is_upright
    return PictureFocus(surface, view, None if straight else chief_rays(camera))
