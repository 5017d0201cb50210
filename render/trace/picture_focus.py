"""Where a picture's pixels are focused: the camera's focal surface as its lens shows it."""

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
        surface: over slopes of object space.
        view: the picture.
        chief: where the lens's chief rays go; None where they go straight.
    """

    surface: FocalSurface
    view: PinholeView
    chief: ChiefRays | None = None

    @property
    def affine(self) -> tuple[float, float, float] | None:
        """w_f at the picture's top left corner and its change from pixel to pixel to the right and down; None where no such
        three numbers say it all."""
        plane = self.surface.plane
        if not self.surface.is_plane or (self.chief is not None and not plane.is_upright):
            return None
        return self.view.across(plane)

    def at(self, places_px: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
        """``(...)`` w_f in 1/m, and ``(...)`` the radius of the pupil over the lens's own, of places ``(..., 2)`` in pixels."""
        slopes = (places_px - [self.view.cx, self.view.cy]) / [self.view.fx, self.view.fy]
        seen = slopes if self.chief is None else self.chief.seen_at(slopes)
        return focused_at(self.surface, seen * [1.0, -1.0])

    def over_picture(self) -> tuple[DoubleArray, DoubleArray]:
        """`at` of a grid of places all over the picture, and of those that control points stand at."""
        x, y = np.meshgrid(np.linspace(0, self.view.width, _GRID), np.linspace(0, self.view.height, _GRID))
        w, pupil = self.at(np.stack([x, y], axis=-1).reshape(-1, 2))
        if self.surface.controls is None:
            return w, pupil
        more_w, more_pupil = focused_at(self.surface, self.surface.controls.places)
        return np.concatenate([w, more_w]), np.concatenate([pupil, more_pupil])


def picture_focus(camera: Camera, view: PinholeView) -> PictureFocus:
    """The camera's focal surface, or the upright plane at its focus distance, in a picture of it."""
    surface = focal_surface(camera)
    straight = surface.is_plane and surface.plane.is_upright
    return PictureFocus(surface, view, None if straight else chief_rays(camera))
