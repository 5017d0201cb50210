"""Single-image engines: one peeling from the pupil's centre, and a blur of what it shows."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import moderngl
import numpy as np

from render.gl.cancellation import NEVER_CANCELLED, CancellationPoint
from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.layers.peel import Layers, Peeler
from render.layers.surface_sampling import sampling_of_layers
from render.layers.umbra import layers_needed, umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.postblur.flag_blur import FlagBlur
from render.postblur.gather import GatherBlur
from render.postblur.importance import ImportanceBlur
from render.postblur.linear import LinearBlur
from render.postblur.scatter import ScatterBlur
from render.postblur.sides import Blur, Collector
from render.trace.axis_rays import LensErrors
from render.trace.bundles import BundleMaker
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import ray_pattern

MAX_MARGIN = 0.125
"""Of the picture's longer side, what is peeled around it at most for what it sheds into it."""
_DRAWS_ERRORS = ("scatter",)
"""Engines that draw the lens's errors on its axis."""
_KEPT_STEP = 16
"""Pixels by which that grows where pictures are kept from frame to frame, which are of one size."""
_ALIKE = 100
"""Rays of a lens whose sampling of surfaces this is like."""


class PostBlurEngine:
    """Blurs pictures of a peeler's scene, with the programs of one context."""

    def __init__(
        self, ctx: moderngl.Context, programs: ProgramCache, cancellation: CancellationPoint = NEVER_CANCELLED
    ) -> None:
        self._collector = Collector(ctx, programs)
        self._blurs: dict[str, Blur] = {
            "flag": FlagBlur(ctx, programs, cancellation),
            "gather": GatherBlur(ctx, programs, cancellation),
            "linear": LinearBlur(ctx, programs, cancellation),
            "scatter": ScatterBlur(ctx, programs, cancellation),
            "importance": ImportanceBlur(ctx, programs, cancellation),
        }
        self._bundles = BundleMaker(ctx, programs)

    @property
    def engines(self) -> Collection[str]:
        """Their names."""
        return self._blurs.keys()

    def picture(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        engine: str,
        *,
        layers: int,
        supersample: float = 1.0,
        unlit: bool = False,
    ) -> FloatArray:
        """Peel the loaded scene and blur it.

        Args:
            peeler: with the scene loaded.
            camera: its iris, stop, squeeze and focus count; its lens is taken for ideal, but for what `scatter` draws of it.
            view: the picture, from the pupil's centre.
            engine: one of `engines`.
            layers: at most this many layers.
            supersample: pixels that are blurred to one of the picture's along each axis, rounded up to whole ones.
            unlit: take base colour for radiance.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        fine = int(np.ceil(supersample))
        scaled = view.resized(view.width * fine, view.height * fine)
        pupil_px = max(scaled.fx, scaled.fy) * pupil_radius_m(camera)
        nearest_w = peeler.nearest_w(scaled)
        w_f, pupil = picture_focus(camera, scaled).over_picture()
        most_px = float((pupil_px * pupil * np.maximum(w_f, np.abs(nearest_w - w_f))).max())
        step = fine * (_KEPT_STEP if engine == "importance" else 1)
        margin = step * int(np.ceil(min(most_px, fine * MAX_MARGIN * max(view.width, view.height)) / step))
        wide = scaled.widened(margin)
        reach = pupil_px * float(pupil.max())
        if peeler.is_opaque:
            layers = min(layers, layers_needed(reach, nearest_w))
        focus = picture_focus(camera, wide)
        sampling = sampling_of_layers(wide, scaled, focus.affine or (0.0, 0.0, 0.0), reach / wide.fx, _ALIKE)
        peeled = peeler.peel(wide, layers=layers, umbra=umbra_reach(reach), unlit=unlit, sampling=sampling)
        picture = self.of_layers(peeled, camera, focus, pupil_px, most_px, engine)
        inner = picture[margin : margin + scaled.height, margin : margin + scaled.width]
        return np.ascontiguousarray(inner.reshape(view.height, fine, view.width, fine, 4).mean(axis=(1, 3)))

    def of_layers(
        self, peeled: Layers, camera: Camera, focus: PictureFocus, pupil_px: float, most_px: float, engine: str
    ) -> FloatArray:
        """Blur what was peeled.

        Args:
            peeled: from the pupil's centre.
            camera: its iris and squeeze count.
            focus: of the layers' view.
            pupil_px: the pupil's radius times the focal length, px·m of that view.
            most_px: larger circles of confusion are taken for as large.
            engine: one of `engines`.

        Returns:
            ``(height, width, 4)`` float32 of the layers' view, premultiplied.
        """
        with Resources() as held:
            iris, squeeze = camera.iris, camera.lens.squeeze
            sides = self._collector.sides(peeled, focus, pupil_px, most_px, iris, squeeze, held)
            if engine in _DRAWS_ERRORS:
                sides = replace(sides, errors=self._errors(camera, focus.view))
            blurred = self._blurs[engine].blurred(sides, held)
            return np.frombuffer(blurred.read(), np.float32).reshape(*sides.size[::-1], 4).copy()

    def _errors(self, camera: Camera, view: PinholeView) -> LensErrors | None:
        table = self._bundles.bundle(camera, view, ray_pattern(1, IrisShape()), 1).table
        return None if table is None else LensErrors(table, pupil_radius_m(camera), max(view.fx, view.fy))

    def release(self) -> None:
        """Give the memory back."""
        self._collector.release()
        for blur in self._blurs.values():
            blur.release()
