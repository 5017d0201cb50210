"""AOVs seen through the lens: each pixel's depth and ids along the chief ray, the one through the middle of the pupil.

A holdout, and what it hides, counts as nothing. Gaussian splats are met where their opacity passes one half.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from render.layers.peel import Peeler
from render.layers.readback import read_hits
from render.layers.surface_hits import SurfaceDescription, SurfaceHits
from render.layers.targets import MAX_LAYER_PIXELS
from render.model.aovs import primvar_of
from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.limits import MAX_PICTURE_SIDE_PX
from render.model.surface_points import SurfacePoints
from render.optics.distortion import ChiefRays
from render.optics.view import PinholeView
from render.trace.layer_view import MAX_SLOPE
from render.trace.picture_focus import PictureFocus
from render.trace.rays import RayBundle
from render.trace.sharpness import Sharpness, measure_sharpness
from render.trace.splat_layers import SplatLayers

MAX_AREA_RATIO = 8.0
"""Surfaces are drawn with at most this many times the picture's pixels: a lens that sees further is measured less finely."""


@dataclass(frozen=True, eq=False)
class Measurements:
    """Measured AOVs.

    Attributes:
        values: arrays by name.
        points: what the pixels see, for AOVs that need the stage; None where none was named.
    """

    values: dict[str, NDArray[Any]] = field(default_factory=dict)
    points: SurfacePoints | None = None


@dataclass(frozen=True, eq=False)
class Measurer:
    """Measures AOVs of one picture: a method for each name.

    Attributes:
        view: the picture.
        bundle: the lens.
        focus: focal surface.
        hits: what each pixel's chief ray meets.
        surfaces: their description.
        stage_from_world: `Scene.stage_from_world`.
        set_back_m: `Camera.set_back_m`; depths count from the camera's own origin.
    """

    view: PinholeView
    bundle: RayBundle
    focus: PictureFocus
    hits: SurfaceHits
    surfaces: SurfaceDescription
    stage_from_world: DoubleArray
    set_back_m: float = 0.0

    def measure(self, names: Collection[str]) -> Measurements:
        """Measure those AOVs of the names that are measured along chief rays."""
        values = {name: _MEASURES[name](self) for name in names if name in _MEASURES}
        return Measurements(values, self.surfaces.points if any(map(primvar_of, names)) else None)

    def depth(self) -> FloatArray:
        return depths_m(self.hits.w, self.set_back_m)

    def coc(self) -> FloatArray:
        return _cocs_px(self.hits.w, self._sharp, self.view)

    def defocus(self) -> FloatArray:
        if self.set_back_m == 0:
            return (self.hits.w - self._sharp.w).astype(np.float32)
        with np.errstate(divide="ignore"):
            thing_m, sharp_m = (1 / np.maximum(w, 0.0) - self.set_back_m for w in (self.hits.w, self._sharp.w))
            return (1 / thing_m - 1 / sharp_m).astype(np.float32)

    def focus_depth(self) -> FloatArray:
        return depths_m(self._sharp.w, self.set_back_m)

    def prim_id(self) -> NDArray[np.uint32]:
        return (self.surfaces.prim_ids + 1).astype(np.uint32)

    def element_id(self) -> IntArray:
        return self.surfaces.face_ids

    def prim_index(self) -> IntArray:
        return self.surfaces.prim_ids

    def instance_id(self) -> IntArray:
        return self.surfaces.instance_ids

    def camera_depth(self) -> FloatArray:
        return np.abs(self.eye_position()[..., 2])

    def eye_position(self) -> FloatArray:
        w, slopes = self.hits.w[..., None], self.hits.slopes
        directions = np.concatenate([slopes, np.full_like(w, -1.0)], axis=-1)
        ahead = directions / np.where(w > 0, w, 1.0) + [0.0, 0.0, self.set_back_m]
        there = np.where(w > 0, ahead, 0.0)
        positions: FloatArray = (there * np.linalg.norm(self.stage_from_world[:3, 0])).astype(np.float32)
        return positions

    def eye_normal(self) -> FloatArray:
        return self.surfaces.normals.astype(np.float32)

    def normal(self) -> FloatArray:
        turn = self.stage_from_world[:3, :3] @ np.linalg.inv(self.view.camera_from_world)[:3, :3]
        normals: FloatArray = (self.surfaces.normals @ (turn / np.linalg.norm(turn, axis=0)).T).astype(np.float32)
        return normals

    @cached_property
    def _sharp(self) -> Sharpness:
        return _sharpness(self.bundle, self.focus, self.view)


def depths_m(w: DoubleArray, set_back_m: float) -> FloatArray:
    """AOV ``depth`` of inverse depths ``(height, width)``, 1/m, seen by a camera of that ``Camera.set_back_m``."""
    with np.errstate(divide="ignore"):
        return (1.0 / np.maximum(w, 0.0) - set_back_m).astype(np.float32)


def cocs_px(w: DoubleArray, bundle: RayBundle, focus: PictureFocus, view: PinholeView) -> FloatArray:
    """AOV ``coc`` of inverse depths ``(height, width)``, 1/m, along the chief rays of a picture.

    Args:
        w: inverse depths; 0 where nothing is.
        bundle: the lens.
        focus: focal surface.
        view: the picture.
    """
    return _cocs_px(w, _sharpness(bundle, focus, view), view)


def _cocs_px(w: DoubleArray, sharp: Sharpness, view: PinholeView) -> FloatArray:
    w = np.maximum(w, view.base_w)  # the background is as blurred as what is farthest
    return (view.fx * sharp.pupil_m * (sharp.w - w)).astype(np.float32)


def _sharpness(bundle: RayBundle, focus: PictureFocus, view: PinholeView) -> Sharpness:
    """Sharpness of each pixel, from the origin of inverse depths."""
    sharp = measure_sharpness(bundle, focus, view)
    return replace(sharp, w=sharp.w + view.base_w)


_MEASURES: dict[str, Callable[[Measurer], NDArray[Any]]] = {
    "depth": Measurer.depth,
    "coc": Measurer.coc,
    "defocus": Measurer.defocus,
    "focus_depth": Measurer.focus_depth,
    "prim_id": Measurer.prim_id,
    "face_id": Measurer.element_id,
    "cameraDepth": Measurer.camera_depth,
    "normal": Measurer.normal,
    "Neye": Measurer.eye_normal,
    "Peye": Measurer.eye_position,
    "primId": Measurer.prim_index,
    "instanceId": Measurer.instance_id,
    "elementId": Measurer.element_id,
}


def is_measured(name: str) -> bool:
    """Tell whether an AOV needs the surfaces that chief rays meet."""
    return name in _MEASURES or bool(primvar_of(name))


def chief_hits(peeler: Peeler, view: PinholeView, chief: ChiefRays | None, splats: SplatLayers) -> SurfaceHits:
    """Trace each pixel's chief ray to the first surface, or to splats that hide half of it.

    Args:
        peeler: with the scene loaded.
        view: the picture.
        chief: the lens's chief rays; None where they are straight.
        splats: finds the scene's splats.
    """
    if chief is None:
        return splats.hide(read_hits(peeler, view), peeler.splats, view)
    x, y = np.meshgrid(np.arange(view.width) + 0.5, np.arange(view.height) + 0.5)
    slopes = np.stack([(x - view.cx) / view.fx, (y - view.cy) / view.fy], axis=-1)
    seen = chief.undistort_slopes(slopes)
    seen *= MAX_SLOPE / np.maximum(np.hypot(*np.moveaxis(seen, -1, 0)), MAX_SLOPE)[..., None]  # the lens is dark beyond
    scale = _scale(seen, view)
    seen *= np.array([view.fx, view.fy]) * scale
    left, top = np.floor(seen.reshape(-1, 2).min(axis=0)).astype(int)
    right, bottom = np.ceil(seen.reshape(-1, 2).max(axis=0)).astype(int)
    # one more pixel of margin on the far sides, for a chief ray that falls on the very edge
    wide = replace(
        view,
        width=int(right - left) + 1,
        height=int(bottom - top) + 1,
        fx=view.fx * scale,
        fy=view.fy * scale,
        cx=float(-left),
        cy=float(-top),
    )
    column = (seen[..., 0] - left).astype(int)
    row = (seen[..., 1] - top).astype(int)
    return splats.hide(read_hits(peeler, wide), peeler.splats, wide).at(row, column)


def _scale(seen: DoubleArray, view: PinholeView) -> float:
    """Scale of the pixels in which surfaces at slopes ``(..., 2)`` are drawn, relative to the picture's own; at most 1."""
    span = np.ptp(seen.reshape(-1, 2), axis=0) * [view.fx, view.fy] + 1
    most = min(MAX_AREA_RATIO * view.width * view.height, 0.9 * MAX_LAYER_PIXELS)
    return min(1.0, float(np.sqrt(most / span.prod())), float((MAX_PICTURE_SIDE_PX - 4) / span.max()))
