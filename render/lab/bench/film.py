"""The film bench: what film and grade cost on the device and on the processor, beside the frame itself, on the demo shot.

pullfocus bench film
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from render.demo.shot import write_demo
from render.film import FilmSettings, Grade, film_settings
from render.frame import FrameRenderer
from render.lab.bench.clock import Repeats, Spent, time_work
from render.lab.bench.film_plan import FINISHINGS, FRAME, Finishing, picture_from_arguments
from render.lab.bench.progress import check_file, goal_lines, say
from render.lab.bench.results import Goal
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.pictures.live_finisher import LiveFinisher
from render.shot import Shot
from render.shot.film.finish import Finish
from usd_schemas import FilmData, Sensor

GOAL_SHARE = 0.10
GOAL_APART = 1.0  # of 255 levels, exclusive
FRAME_REPEATS, FINISH_REPEATS = Repeats(2, most=3, enough_ms=20_000), Repeats(5)
SENSOR = Sensor(full_well_e=30000, read_noise_e=5, clip_stops=6)


@dataclass(frozen=True)
class FinishRow:
    """One way to finish the picture. Milliseconds.

    Attributes:
        name: of it.
        live_ms: on the device, the picture sent there and read back, wall time.
        live_cpu_ms: by the processor's, of all threads, which on a software rasteriser do the work.
        first_ms: the first time, when shaders are compiled and curves are sent.
        share: of the frame's time, wall time.
        file_ms: on the processor, as files are finished, wall time.
        file_cpu_ms: by the processor's.
        apart: greatest difference of the two, in 255 levels; the live one is rounded to whole levels.
    """

    name: str
    live_ms: float
    live_cpu_ms: float
    first_ms: float
    share: float
    file_ms: float
    file_cpu_ms: float
    apart: float


@dataclass(frozen=True)
class FilmBench:
    """Results of the film bench; the fields are the keys of its JSON.

    Attributes:
        device: name of the device.
        width: picture width in pixels.
        height: picture height in pixels.
        rays: rays per pixel.
        frame_ms: wall time of the frame without its finish.
        frame_cpu_ms: the same in processor time.
        rows: the ways to finish it.
        goals: goals and whether they are met.
    """

    device: str
    width: int
    height: int
    rays: int
    frame_ms: float
    frame_cpu_ms: float
    rows: list[FinishRow]
    goals: list[Goal]


def measure(picture: FrameSettings, frame_repeats: Repeats, finish_repeats: Repeats) -> FilmBench:
    """Measure everything on the demo shot.

    Raises:
        GraphicsError: there is no device to draw on.
    """
    with tempfile.TemporaryDirectory() as folder, FrameRenderer() as renderer:
        shot = Shot.open(write_demo(Path(folder)))
        camera = shot.camera_at(None, FRAME, picture.width, picture.height)
        scene, drawn = shot.scene_at(FRAME), []
        renderer.render(scene, camera, replace(picture, rays=1))  # compiles shaders, and sends the scene
        finish = renderer.graphics.ctx.finish

        def draw() -> None:
            renderer.forget_layers()
            drawn.append(renderer.render(scene, camera, picture).color)

        frame = time_work(finish, draw, frame_repeats)
        finisher = LiveFinisher(renderer)
        rows = [_row(renderer, finisher, way, drawn[-1], camera, frame, finish_repeats) for way in FINISHINGS]
        finisher.release()
        device = renderer.graphics.renderer
    size = picture.width, picture.height, picture.rays
    return FilmBench(device, *size, frame.wall_ms, frame.cpu_ms, rows, _goals(rows))


def run(arguments: argparse.Namespace) -> None:
    """Measure, print the table on standard output, and write the JSON.

    Args:
        arguments: as `render.lab.bench.film_plan.add_arguments` declares them.

    Raises:
        SettingsError: the picture is too small or too large.
        GraphicsError: there is no device to draw on.
        OutputError: the file cannot be written.
    """
    check_file(arguments.json)
    picture = picture_from_arguments(arguments)
    once = Repeats(1, 1)
    result = measure(picture, *((once, once) if arguments.quick else (FRAME_REPEATS, FINISH_REPEATS)))
    say(result, report(result), arguments.json)


def report(result: FilmBench) -> str:
    """The table."""
    lines = [
        f"{result.device}; the demo shot, {result.width}x{result.height}, {result.rays} rays",
        "Milliseconds by the wall's clock, and in brackets by the processor's, of all threads.",
        f"the frame itself: {result.frame_ms:.0f} ({result.frame_cpu_ms:.0f})",
        "",
        "finish                    on the device   of the frame   the first time   on the processor   apart, of 255 levels",
    ]
    lines += [
        f"{row.name:24}  {row.live_ms:6.1f} {f'({row.live_cpu_ms:.0f})':>6}   {row.share:12.1%}   {row.first_ms:14.0f}"
        f"   {row.file_ms:8.1f} {f'({row.file_cpu_ms:.0f})':>7}   {row.apart:20.2f}"
        for row in result.rows
    ]
    lines += ["", *goal_lines(result.goals)]
    return "\n".join(lines) + "\n"


def _row(
    renderer: FrameRenderer,
    finisher: LiveFinisher,
    way: Finishing,
    light: FloatArray,
    camera: Camera,
    frame: Spent,
    repeats: Repeats,
) -> FinishRow:
    finish, pictures = Finish(Grade(), _film(way)), {}

    def live() -> None:
        pictures["live"] = finisher.finish(finish, light, camera, time=FRAME, seed=0)

    def file() -> None:
        pictures["file"] = finish.apply(light, camera, time=FRAME, seed=0)

    first, device = (
        time_work(renderer.graphics.ctx.finish, live, Repeats(1, 1)),
        time_work(renderer.graphics.ctx.finish, live, repeats),
    )
    file()  # numpy keeps kernels and tables too
    processor = time_work(renderer.graphics.ctx.finish, file, repeats)
    return FinishRow(
        name=way.name,
        live_ms=device.wall_ms,
        live_cpu_ms=device.cpu_ms,
        first_ms=first.wall_ms,
        share=device.wall_ms / frame.wall_ms,
        file_ms=processor.wall_ms,
        file_cpu_ms=processor.cpu_ms,
        apart=255 * float(np.abs(pictures["live"] - pictures["file"]).max()),
    )


def _film(way: Finishing) -> FilmSettings | None:
    if way.digital:
        return film_settings(FilmData("digital", sensor=SENSOR))
    if way.stock is None:
        return None
    film = film_settings(FilmData(), name=way.stock)
    return replace(film, grain=replace(film.grain, amount=1.0), halation=way.halation)


def _goals(rows: list[FinishRow]) -> list[Goal]:
    worst = max(rows, key=lambda row: row.share)
    furthest = max(rows, key=lambda row: row.apart)
    return [
        Goal(
            f"film and grade on the device ({worst.name}), share of the frame below",
            GOAL_SHARE,
            worst.share,
            worst.share < GOAL_SHARE,
        ),
        Goal(
            f"device and processor ({furthest.name}), of 255 levels apart below",
            GOAL_APART,
            furthest.apart,
            furthest.apart < GOAL_APART,
        ),
    ]
