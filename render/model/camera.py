"""A camera at one time, as plain data: pose, film gate, lens, focus and shutter.

Defined without pxr, like `render.model.scene`, whose conventions hold here too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from render.model.arrays import DoubleArray
from render.model.focal_surface import FocalSurface
from render.model.lens import THIN_LENS, IrisShape, Lens
from render.model.shutter import GLOBAL_SHUTTER, Shutter


@dataclass(frozen=True)
class Orthographic:
    """An orthographic camera as its prim states it, where the camera is a perspective one far away.

    Attributes:
        set_back_m: distance of the pupil behind the prim's origin. Focus distance and depths of the camera count from the pupil.
        focal_length_mm: that of the prim, which has no meaning.
    """

    set_back_m: float
    focal_length_mm: float


@dataclass(frozen=True, eq=False)
class Camera:
    """A camera at one time.

    Attributes:
        world_from_camera: ``(4, 4)`` float64 rigid, metres; looks along -Z, +Y up, +X right.
        focal_length_mm: with the apertures it gives the field of view.
        horizontal_aperture_mm: width of the film gate that the picture shows (after conforming to its aspect ratio).
        vertical_aperture_mm: its height.
        horizontal_offset_mm: of the gate's centre from the axis.
        vertical_offset_mm: likewise.
        f_stop: f-number; 0 is a pinhole, as in USD.
        focus_distance_m: along the axis, from the entrance pupil; 0 or infinite focuses at infinity.
        near_m: nearest depth drawn.
        far_m: farthest depth drawn; may be infinite.
        exposure_scale: what UsdGeomCamera's exposure attributes multiply radiance by.
        iris: the shape of the opening.
        lens: the glass.
        focal_surface: where the focus lies over the picture, in place of the plane at the focus distance; None for that plane.
        shutter_open: in frames relative to the time, as in USD.
        shutter_close: likewise.
        shutter: how it opens, and in which order it bares the picture.
        breathing: whether the physical image distance sets the field of view.
        circles_by_image_distance: whether readouts take the image distance for the focal length in circles of confusion.
        clip_planes: ``(a, b, c, d)`` each, at most `render.model.limits.MAX_CLIP_PLANES`: nothing is drawn where
            ``a·x + b·y + c·z + d < 0`` in camera space, metres.
        whole_diagonal_mm: diagonal of the whole film gate, which the lens covers, where the picture shows another part of the
            film; None where the gate is the whole.
        orthographic: of an orthographic camera, which is a perspective one far away here; None of any other.
        path: prim path.
    """

    world_from_camera: DoubleArray
    focal_length_mm: float = 50.0
    horizontal_aperture_mm: float = 36.0
    vertical_aperture_mm: float = 20.25
    horizontal_offset_mm: float = 0.0
    vertical_offset_mm: float = 0.0
    f_stop: float = 0.0
    focus_distance_m: float = 0.0
    near_m: float = 0.01
    far_m: float = float("inf")
    exposure_scale: float = 1.0
    iris: IrisShape = field(default_factory=IrisShape)
    lens: Lens = THIN_LENS
    focal_surface: FocalSurface | None = None
    shutter_open: float = 0.0
    shutter_close: float = 0.0
    shutter: Shutter = GLOBAL_SHUTTER
    breathing: bool = False
    circles_by_image_distance: bool = False
    clip_planes: tuple[tuple[float, float, float, float], ...] = ()
    whole_diagonal_mm: float | None = None
    orthographic: Orthographic | None = None
    path: str = ""

    @property
    def covered_mm(self) -> float:
        """Diameter of the film that the lens covers."""
        own = math.hypot(self.horizontal_aperture_mm, self.vertical_aperture_mm)
        return own if self.whole_diagonal_mm is None else self.whole_diagonal_mm

    @property
    def set_back_m(self) -> float:
        """Distance of the pupil behind the prim's origin: 0 but for an orthographic camera."""
        return 0.0 if self.orthographic is None else self.orthographic.set_back_m

    @property
    def stated_focus_m(self) -> float:
        """Focus distance from the prim's origin, as the prim states it; infinite for infinity."""
        return (self.focus_distance_m or math.inf) - self.set_back_m

    @property
    def stated_focal_length_mm(self) -> float:
        """Focal length as the prim states it."""
        return self.focal_length_mm if self.orthographic is None else self.orthographic.focal_length_mm
