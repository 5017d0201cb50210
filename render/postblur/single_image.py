"""Blurs of a single image: one peeling from the pupil's centre, and a blur of its picture."""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.layers.surface_sampling import layer_sampling
from render.layers.umbra import layers_needed, umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.optics.thin_lens import pupil_radius_m
from render.optics.view import PinholeView
from render.postblur.focus_split import Blur, FocusSplitter
from render.trace.axis_rays import LensErrors
from render.trace.bundles import BundleMaker
from render.trace.picture_focus import PictureFocus, picture_focus
from render.trace.rays import make_ray_pattern
from render.trace.splat_layers import SplatLayers

MAX_MARGIN = 0.125
"""Largest margin peeled around the picture for the light that is blurred into it, as a share of the longer side."""
MOST_DIAGONALS = 4.0
"""Largest radius, up and down, of a circle of confusion in diagonals of the picture.

Without a squeeze, all of the picture then gets nearly even light.
"""
_MOST_PUPIL_PX = 1e30  # px·m; the shaders' numbers end at 3e38
_RAYS_ALIKE = 100
"""Rays of the lens tracer whose texture filter a blur's layers have."""


class SingleImageBlur:
    """Peels the loaded scene and blurs it, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._splitter = FocusSplitter(ctx, programs)
        self._bundles = BundleMaker(ctx, programs)
        self._splats = SplatLayers(ctx, programs)

    def draw(
        self,
        peeler: Peeler,
        camera: Camera,
        view: PinholeView,
        blur: Blur,
        *,
        layers: int,
        supersample: float = 1.0,
        unlit: bool = False,
        margin_step: int = 1,
        with_axis_errors: bool = False,
    ) -> FloatArray:
        """Peel the loaded scene and blur it.

        Args:
            peeler: with the scene loaded.
            camera: its iris, stop, squeeze and focus count; its lens is taken for ideal, but for errors on its axis.
            view: the picture, from the pupil's centre.
            blur: spreads each point over its circle of confusion.
            layers: at most this many layers.
            supersample: pixels that are blurred to one of the picture's along each axis, rounded up to whole ones.
            unlit: take base colour for radiance.
            margin_step: pixels of the picture by which the margin around it grows.
            with_axis_errors: give the blur the lens's errors on its axis.

        Returns:
            ``(height, width, 4)`` float32, premultiplied.
        """
        fine = int(np.ceil(supersample))
        scaled = view.resize(view.width * fine, view.height * fine)
        pupil_px = max(scaled.fx, scaled.fy) * pupil_radius_m(camera)
        nearest_w = peeler.nearest_w(scaled)
        inside = picture_focus(camera, scaled)
        most_px = largest_radius_px(inside, pupil_px, nearest_w)
        step = fine * margin_step
        wide_px = most_px * max(1.0, 1.0 / camera.lens.squeeze)
        margin = step * int(np.ceil(min(wide_px, fine * MAX_MARGIN * max(view.width, view.height)) / step))
        focus = picture_focus(camera, scaled.widen(margin))
        reach = pupil_px * float(inside.over_picture()[1].max())
        peeled = _peel(peeler, scaled, focus, reach, nearest_w, layers, unlit)
        picture = self.blur_layers(
            peeled, camera, view, focus, pupil_px, most_px, blur, with_axis_errors=with_axis_errors
        )
        inner = picture[margin : margin + scaled.height, margin : margin + scaled.width]
        return np.ascontiguousarray(inner.reshape(view.height, fine, view.width, fine, 4).mean(axis=(1, 3)))

    def blur_layers(
        self,
        peeled: Layers,
        camera: Camera,
        view: PinholeView,
        focus: PictureFocus,
        pupil_px: float,
        most_px: float,
        blur: Blur,
        *,
        with_axis_errors: bool = False,
    ) -> FloatArray:
        """Blur peeled layers. Radii above `MOST_DIAGONALS` times the diagonal of the layers' view are taken for as large.

        Args:
            peeled: from the pupil's centre.
            camera: its iris and squeeze count.
            view: the picture, in whose pixels the splats' edges are softened.
            focus: of the layers' view.
            pupil_px: the pupil's radius times the focal length, px·m of that view.
            most_px: larger circles of confusion are taken for as large.
            blur: spreads each point over its circle of confusion.
            with_axis_errors: give the blur the lens's errors on its axis.

        Returns:
            ``(height, width, 4)`` float32 of the layers' view, premultiplied.
        """
        most_px = min(most_px, MOST_DIAGONALS * float(np.hypot(focus.view.width, focus.view.height)))
        pupil_px = min(pupil_px, _MOST_PUPIL_PX)
        with Resources() as scope:
            wide = focus.view
            pupil_m = pupil_px / max(wide.fx, wide.fy)
            splats = self._splats.painting(peeled.splats, wide, view, focus, pupil_m)(peeled)
            split = self._splitter.split(
                peeled, focus, pupil_px, most_px, camera.iris, camera.lens.squeeze, scope, splats
            )
            if with_axis_errors:
                split = replace(split, errors=self._axis_errors(camera, focus.view))
            blurred = blur.blur(split, scope)
            return np.frombuffer(blurred.read(), np.float32).reshape(*split.size[::-1], 4).copy()

    def _axis_errors(self, camera: Camera, view: PinholeView) -> LensErrors | None:
        table = self._bundles.make_bundle(camera, view, make_ray_pattern(1, IrisShape()), 1).table
        if table is None:
            return None
        own_squeeze = camera.lens.squeeze / camera.lens.drawn_squeeze
        return LensErrors(table, pupil_radius_m(camera), max(view.fx, view.fy), own_squeeze)

    def release(self) -> None:
        """Release the memory."""
        self._splitter.release()
        self._splats.release()


def largest_radius_px(focus: PictureFocus, pupil_px: float, nearest_w: float) -> float:
    """Bound the circles of confusion of a picture.

    Args:
        focus: where each pixel is focused.
        pupil_px: the pupil's radius times the focal length, px·m.
        nearest_w: largest inverse depth of any surface in view, 1/m; the background has 0.

    Returns:
        A radius in pixels.
    """
    w_f, pupil = focus.over_picture()
    return float((pupil_px * pupil * np.maximum(w_f, np.abs(nearest_w - w_f))).max())


def _peel(
    peeler: Peeler,
    picture: PinholeView,
    focus: PictureFocus,
    reach: float,
    nearest_w: float,
    layers: int,
    unlit: bool,
) -> Layers:
    """Peel the focus's view, which is the picture with a margin; ``reach`` is the pupil's radius in px·m."""
    wide = focus.view
    if peeler.is_opaque:
        layers = min(layers, layers_needed(reach, nearest_w))
    sampling = layer_sampling(wide, picture, focus.affine or (0.0, 0.0, 0.0), reach / wide.fx, _RAYS_ALIKE)
    return peeler.peel(wide, layers=layers, umbra=umbra_reach(reach), unlit=unlit, sampling=sampling)
