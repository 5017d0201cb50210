"""Distance of each single-image engine from the lens tracer and from the accumulation buffer."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from render.demo.shot import write_demo
from render.engines import engine_names
from render.frame import FrameRenderer
from render.lab.bench.clock import Repeats, Spent, time_work
from render.lab.bench.postblur.plan import F_STOP, FRAME, PostBlurPlan
from render.lab.reference.metrics import psnr_db, ssim
from render.lab.reference.scenes import posts_before_wall, spheres_over_checkerboard
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.shot import Shot

ONCE = Repeats(1, 1)


@dataclass(frozen=True)
class QualityRow:
    """One engine's picture of one scene.

    Attributes:
        scene: its name.
        engine: likewise.
        ms: the whole picture, by the wall's clock, what is kept from the picture before not made again: of ``importance`` all
            but what has changed, which is nothing.
        cpu_ms: by the processor's, of all threads.
        lens_psnr_db: against the lens tracer; None for itself.
        lens_ssim: the same comparison.
        accumulation_psnr_db: against the accumulation buffer; None for itself.
        accumulation_ssim: the same comparison.
    """

    scene: str
    engine: str
    ms: float
    cpu_ms: float
    lens_psnr_db: float | None
    lens_ssim: float | None
    accumulation_psnr_db: float | None
    accumulation_ssim: float | None


def quality(renderer: FrameRenderer, plan: PostBlurPlan) -> Iterator[QualityRow]:
    """Every engine's picture of every scene."""
    for name, make in (("spheres", spheres_over_checkerboard), ("posts", posts_before_wall)):
        scene, camera = make()
        yield from _scene_rows(renderer, name, scene, replace(camera, f_stop=F_STOP), plan.picture)
    if plan.demo is not None:
        demo = plan.demo
        with tempfile.TemporaryDirectory() as folder:
            shot = Shot.open(write_demo(Path(folder)))
            camera = shot.camera_at(None, FRAME, demo.width, demo.height)
            yield from _scene_rows(renderer, "demo shot", shot.scene_at(FRAME), camera, demo)


def _scene_rows(
    renderer: FrameRenderer, name: str, scene: Scene, camera: Camera, settings: FrameSettings
) -> Iterator[QualityRow]:
    drawn: dict[str, tuple[FloatArray, Spent]] = {}
    for engine in sorted(engine_names(), key=_rank):
        pictures: list[FloatArray] = []
        take = partial(_take, renderer, scene, camera, replace(settings, engine=engine), pictures)
        if engine not in ("lens", "accumulation"):
            take()  # compiles
        spent = time_work(renderer.graphics.ctx.finish, take, ONCE)
        drawn[engine] = pictures[-1], spent
    for engine, (picture, spent) in drawn.items():
        alike = [
            measure(picture, drawn[reference][0]) if engine != reference else None
            for reference in ("lens", "accumulation")
            for measure in (psnr_db, ssim)
        ]
        yield QualityRow(name, engine, spent.wall_ms, spent.cpu_ms, *alike)


def _take(
    renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings, pictures: list[FloatArray]
) -> None:
    pictures.append(renderer.render(scene, camera, settings).color * camera.exposure_scale)


def _rank(engine: str) -> int:
    """Place in the table: the two references, the picture without blur, then the others as they are listed."""
    first = ("lens", "accumulation", "pinhole")
    return first.index(engine) if engine in first else len(first)
