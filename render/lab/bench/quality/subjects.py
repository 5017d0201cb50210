"""Subjects of the quality bench: the demo shot lit, through a thin lens and through glass, and generated scenes lit and unlit."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from render.demo.shot import write_demo
from render.lab.bench.quality.plan import GENERATED, GLASS, GLASS_FRAME, GLASS_WIDTH, UNLIT, WIDTH
from render.lab.reference.bench_scenes import SCENES
from render.lab.reference.unlit_scenes import UNLIT_SCENES
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens


@dataclass(frozen=True, eq=False)
class Subject:
    """Scene and camera of a comparison.

    Attributes:
        name: from `render.lab.bench.quality.plan.SUBJECTS`.
        scene: the scene.
        camera: the camera.
        settings: size and shading; all else is the default.
        reference: samples of its converged picture: ``views`` of the accumulation buffer, ``rays`` one by one, or None for a lit
            picture through glass, which neither shows.
    """

    name: str
    scene: Scene
    camera: Camera
    settings: FrameSettings
    reference: str | None


def make_subject(name: str, width: int, folder: Path) -> Subject:
    """Make a subject.

    Args:
        name: from `render.lab.bench.quality.plan.SUBJECTS`.
        width: of the pictures of the plan, in pixels.
        folder: for the files of the demo shot.
    """
    if name in UNLIT:
        width = round(width * 640 / WIDTH)
        return Subject(
            name, *UNLIT_SCENES[name](), FrameSettings(width, _three_quarters(width), shading="unlit"), "views"
        )
    if name in GENERATED:
        return Subject(name, *SCENES[name](), FrameSettings(width, _three_quarters(width)), "views")
    if name == f"glass_{GLASS_FRAME}":
        width = min(width, GLASS_WIDTH)
        return _demo(name, GLASS_FRAME, FrameSettings(width, _wide(width), shading="unlit"), folder, "rays", glass=True)
    frame, _, lens = name.removeprefix("demo_").partition("_")
    settings = FrameSettings(width, _wide(width))
    return _demo(name, int(frame), settings, folder, None if lens else "views", glass=bool(lens))


def _demo(
    name: str, frame: int, settings: FrameSettings, folder: Path, reference: str | None, *, glass: bool
) -> Subject:
    shot = Shot.open(write_demo(folder))
    if glass:
        shot.camera.mount_lens(None, choose_lens(GLASS))
    camera = shot.camera_at(None, frame, settings.width, settings.height)
    return Subject(name, shot.scene_at(frame), camera, settings, reference)


def _three_quarters(width: int) -> int:
    return max(1, round(width * 3 / 4))


def _wide(width: int) -> int:
    return max(1, round(width * 9 / 16))
