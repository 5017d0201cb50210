"""Converged pictures: means of many parts, each a rendering with sample points of its own.

Parts are kept in a file, so that minutes of work can be interrupted and go on. Two halves of the parts are summed apart: their
difference is twice the noise of the whole, whose PSNR is so 6 dB above theirs. The filter of the pixel is the box.

Thin lenses are shown by the accumulation buffer. Its views have `DETAIL` times the resolution of the picture along each axis, and
textures are filtered over a quarter of a pixel. Other lenses are traced ray by ray (`render.lab.reference.ray_by_ray`), unlit.
"""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from render.files import write_atomic
from render.frame import FrameRenderer
from render.lab.reference.metrics import psnr_db
from render.lab.reference.ray_by_ray import ray_by_ray_picture
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.limits import MAX_RAYS
from render.model.scene import Scene
from render.optics.thin_lens import focal_surface
from render.optics.view import PinholeView
from render.trace.accumulator import Accumulator, choose_view_sampling, make_lens_points

DETAIL = 2
"""Pixels of a view of the accumulation buffer per pixel of the picture, along each axis."""
TEXTURE_DETAIL = 2
"""Texture footprints per pixel of a view."""
VIEWS_PER_PART, RAYS_PER_PART = 32, 32

DrawPart = Callable[[int, int], FloatArray]
"""Function of the first sample and the number of samples of a part: its picture, ``(height, width, 4)``."""


@dataclass(frozen=True, eq=False)
class Converged:
    """Sums of parts.

    Attributes:
        sums: ``(2, height, width, 4)`` float64: parts of even number and of odd number, each picture times its samples.
        samples: views or rays in each sum.
        key: what the picture shows.
    """

    sums: DoubleArray
    samples: tuple[int, int]
    key: str

    @property
    def count(self) -> int:
        """Views or rays per pixel."""
        return sum(self.samples)

    @property
    def picture(self) -> FloatArray:
        """The mean, ``(height, width, 4)`` float32."""
        return np.asarray(self.sums.sum(axis=0) / self.count, np.float32)

    @property
    def halves_psnr_db(self) -> float:
        """PSNR of one half of the samples against the other in dB; NaN before there are two."""
        if 0 in self.samples:
            return float("nan")
        even, odd = (total / count for total, count in zip(self.sums, self.samples, strict=True))
        return psnr_db(even.astype(np.float32), odd.astype(np.float32))


def accumulate_converged(
    renderer: FrameRenderer,
    scene: Scene,
    camera: Camera,
    settings: FrameSettings,
    file: Path,
    *,
    say: Callable[[str], None],
    is_stale: Callable[[], bool] = lambda: False,
) -> Converged:
    """Converged picture of a thin lens, by the accumulation buffer. Continues the picture that the file holds.

    Args:
        renderer: draws the views.
        scene: the scene.
        camera: with a thin lens and a plane of focus.
        settings: size, shading, seed; the number of views is ``rays``.
        file: for the sums. What it holds of another picture is replaced.
        say: receives progress messages.
        is_stale: asked after each part whether to stop there.

    Raises:
        SettingsError: the camera has another lens or a bent focal surface.
        OutputError: the file cannot be written.
    """
    settings = replace(settings, engine="accumulation", supersample=TEXTURE_DETAIL)
    fine = PinholeView.from_camera(camera, DETAIL * settings.width, DETAIL * settings.height)
    points = make_lens_points(camera, MAX_RAYS, settings.seed)
    with renderer.on_device():
        camera = renderer.load(scene, camera, settings)
        accumulator = Accumulator(renderer.device.graphics.ctx, renderer.device.programs)
        sampling = choose_view_sampling(camera, fine, MAX_RAYS, settings.supersample)

        def draw(first: int, count: int) -> FloatArray:
            picture = accumulator.accumulate(
                renderer.device.peeler,
                fine,
                points[first : first + count],
                focal_surface(camera).plane,
                unlit=settings.shading == "unlit",
                sampling=sampling,
            )
            pixels = picture.reshape(settings.height, DETAIL, settings.width, DETAIL, 4)
            return np.asarray(pixels.mean(axis=(1, 3)))

        key = _key(scene, camera, settings, f"views of {DETAIL} x {DETAIL}")
        return _add_parts(draw, settings, key, file, VIEWS_PER_PART, say, is_stale)


def trace_converged(
    scene: Scene,
    camera: Camera,
    settings: FrameSettings,
    file: Path,
    *,
    say: Callable[[str], None],
    is_stale: Callable[[], bool] = lambda: False,
) -> Converged:
    """Converged picture of any lens, ray by ray and unlit. Arguments and errors are those of `accumulate_converged`."""

    def draw(first: int, count: int) -> FloatArray:
        seed = settings.seed + 1 + first
        return ray_by_ray_picture(scene, camera, width=settings.width, height=settings.height, rays=count, seed=seed)

    key = _key(scene, camera, settings, "rays")
    return _add_parts(draw, settings, key, file, RAYS_PER_PART, say, is_stale)


def _add_parts(
    draw: DrawPart,
    settings: FrameSettings,
    key: str,
    file: Path,
    per_part: int,
    say: Callable[[str], None],
    is_stale: Callable[[], bool],
) -> Converged:
    made = _read(file, key) or Converged(np.zeros((2, settings.height, settings.width, 4)), (0, 0), key)
    while made.count < settings.rays and not is_stale():
        count = min(per_part, settings.rays - made.count)
        picture = draw(made.count, count)
        sums, samples = made.sums.copy(), list(made.samples)
        half = int(samples[1] < samples[0])
        sums[half] += count * picture.astype(np.float64)
        samples[half] += count
        made = Converged(sums, (samples[0], samples[1]), key)
        write_atomic(file, _packed(made))
        say(f"{file.stem}: {made.count} of {settings.rays}, halves {made.halves_psnr_db:.1f} dB alike")
    return made


def _read(file: Path, key: str) -> Converged | None:
    """Sums that are kept in a file; None where there are none, or of another picture."""
    try:
        with np.load(file) as kept:
            found = Converged(kept["sums"], (int(kept["samples"][0]), int(kept["samples"][1])), str(kept["key"]))
    except (OSError, KeyError, ValueError, zipfile.BadZipFile):
        return None
    return found if found.key == key else None


def _packed(made: Converged) -> bytes:
    packed = io.BytesIO()
    np.savez(packed, sums=made.sums, samples=np.array(made.samples), key=np.array(made.key))
    return packed.getvalue()


def _key(scene: Scene, camera: Camera, settings: FrameSettings, samples: str) -> str:
    """Key of a picture, by numbers that do not depend on how a scene is cut into batches."""
    numbers = (
        scene.triangle_count,
        len(scene.lights),
        *np.round(camera.world_from_camera, 6).ravel().tolist(),
        camera.focal_length_mm,
        camera.f_stop,
        round(camera.focus_distance_m, 6),
        settings.width,
        settings.height,
        settings.seed,
    )
    return f"{settings.shading}, {camera.lens.name or camera.lens.model}, {samples}: " + " ".join(
        map("{:g}".format, numbers)
    )
