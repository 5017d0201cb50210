"""The slow right picture: every ray of every pixel through the lens on its own, to the scene's own triangles.

No layers, no tables, no fits. Its samples of pupil and pixel are those of the fast engines (`render.optics.sampling`, one pattern
for all pixels), so that what differs between the pictures is what the fast ones approximate. Shading is ``unlit``.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from render.lab.reference.lens_rays import lens_rays
from render.lab.reference.unlit import UnlitScene, from_packets, in_packets
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.scene import Scene
from render.optics.sampling import lens_samples
from render.optics.view import PinholeView

CHANNEL_WAVELENGTHS_NM = (650.0, 510.0, 475.0)


def ray_by_ray_picture(
    scene: Scene,
    camera: Camera,
    *,
    width: int,
    height: int,
    rays: int,
    wavelengths_nm: tuple[float, float, float] = CHANNEL_WAVELENGTHS_NM,
    seed: int = 0,
    on_progress: Callable[[float], None] | None = None,
) -> FloatArray:
    """Render one picture.

    Args:
        scene: scene.
        camera: what looks, with its lens: thin (or pinhole), seidel, spherical, heightField or prescription.
        width: pixels.
        height: pixels.
        rays: for each pixel and channel.
        wavelengths_nm: of red, green and blue.
        seed: of the sampling pattern.
        on_progress: called with the share that is done.

    Returns:
        ``(height, width, 4)`` float32: radiance premultiplied by coverage (with the dome behind), and coverage.

    Raises:
        SettingsError: the picture, the rays or the lens's settings are out of range.
        InputError: the prescription is not a lens.
    """
    view = PinholeView.from_camera(camera, width, height)
    samples = lens_samples(rays, camera.iris, seed=seed, tiled=False)
    lens = lens_rays(camera, samples.pupil[0], _corner(view))
    seen_by = UnlitScene(scene, view.camera_from_world, near_m=view.near_m, far_m=view.far_m)
    picture = np.zeros((height, width, 4))
    groups = _groups(wavelengths_nm if lens.has_colours else (wavelengths_nm[0],) * 3)
    for sample in range(rays):
        ideal = _ideal_slopes(view, samples.pixel[0, sample])
        for wavelength, channels in groups:
            through = lens.rays(sample, ideal, wavelength)
            packets = seen_by.radiance(in_packets(through.offsets), in_packets(through.slopes))
            seen = through.weights[..., None] * from_packets(packets, height, width)
            picture[..., channels] += seen[..., channels] * camera.lens.transmittance
            picture[..., 3] += seen[..., 3] * len(channels) / 3
        if on_progress is not None:
            on_progress((sample + 1) / rays)
    return (picture / rays).astype(np.float32)


def _groups(wavelengths_nm: tuple[float, ...]) -> list[tuple[float, list[int]]]:
    """Each wavelength once, with the channels that it is for."""
    return [(nm, [i for i, other in enumerate(wavelengths_nm) if other == nm]) for nm in dict.fromkeys(wavelengths_nm)]


def _ideal_slopes(view: PinholeView, jitter_px: DoubleArray) -> DoubleArray:
    """``(h, w, 2)`` slopes, right and up, of what pixels see through the pupil's centre."""
    x, y = np.arange(view.width) + 0.5 + jitter_px[0], np.arange(view.height) + 0.5 + jitter_px[1]
    return np.stack(np.meshgrid((x - view.cx) / view.fx, (view.cy - y) / view.fy), axis=-1)


def _corner(view: PinholeView) -> tuple[float, float]:
    """Largest slopes of any place of the picture."""
    return max(view.cx, view.width - view.cx) / view.fx, max(view.cy, view.height - view.cy) / view.fy
