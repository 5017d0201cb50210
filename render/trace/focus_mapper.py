"""Focus maps: circle of confusion and depth of each pixel, from depths that are kept while the focus and the stop change."""

from __future__ import annotations

from collections import OrderedDict
from weakref import ReferenceType, ref

from render.layers.peel import Peeler
from render.layers.surface_hits import without_holdouts
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.content import digest_of
from render.model.focus_map import FocusMap
from render.model.lens import IrisShape
from render.model.scene import Scene
from render.optics.distortion import chief_rays
from render.optics.view import PinholeView
from render.trace.aovs import chief_hits, cocs_px, depths_m
from render.trace.bundles import BundleMaker
from render.trace.picture_focus import picture_focus
from render.trace.rays import make_ray_pattern
from render.trace.splat_layers import SplatLayers

_KEPT = 2
"""Depths that are kept: those of a preview and of the picture at rest."""
_Kept = tuple[ReferenceType[Scene], PinholeView, DoubleArray]


class FocusMapper:
    """Measures focus maps. Drawing the surfaces takes nearly all of the time, and a change of focus or stop leaves them.

    Args:
        bundles: makes the lens's rays.
        splats: finds the splats that chief rays meet.
    """

    def __init__(self, bundles: BundleMaker, splats: SplatLayers) -> None:
        self._bundles, self._splats = bundles, splats
        self._kept: OrderedDict[tuple[object, ...], _Kept] = OrderedDict()

    def measure(self, peeler: Peeler, scene: Scene, camera: Camera, view: PinholeView, wavelengths: int) -> FocusMap:
        """Measure a focus map.

        Args:
            peeler: with the scene loaded.
            scene: that scene.
            camera: the camera as its engine draws it.
            view: the picture.
            wavelengths: number of wavelengths that the picture's rays are traced for; sharpness is that of the middle one.

        Raises:
            InputError: the prescription is not a lens.
            SettingsError: it does not reach the focus distance.
        """
        bundle = self._bundles.make_bundle(camera, view, make_ray_pattern(1, IrisShape()), wavelengths)
        w = self._depths(peeler, scene, camera, view)
        return FocusMap(
            coc_px=cocs_px(w, bundle, picture_focus(camera, view), view),
            depth_m=depths_m(w, camera.set_back_m),
            film_mm_per_px=camera.horizontal_aperture_mm / view.width,
        )

    def _depths(self, peeler: Peeler, scene: Scene, camera: Camera, view: PinholeView) -> DoubleArray:
        """Inverse depths of the surfaces that chief rays meet, drawn unless they are kept; 0 where a holdout is met.

        They depend on the scene, which never changes, on the view and on the lens's distortion.
        """
        chief = chief_rays(camera)
        key = view.size, digest_of(chief)
        kept = self._kept.pop(key, None)
        if kept is None or kept[0]() is not scene or not kept[1].matches(view):
            hits = without_holdouts(chief_hits(peeler, view, chief, self._splats), peeler.index.draws)
            kept = ref(scene), view, hits.w
        self._kept[key] = kept
        while len(self._kept) > _KEPT:
            self._kept.popitem(last=False)
        return kept[2]

    def release(self) -> None:
        """Release the memory."""
        self._kept.clear()
