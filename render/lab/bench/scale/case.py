"""One case of the scale bench, in a process of its own: opens a stage, draws pictures and writes what that took.

python -m render.lab.bench.scale.case STAGE WIDTH FILE
"""

from __future__ import annotations

import json
import resource
import sys
from itertools import count, pairwise
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

from render.frame import FrameRenderer
from render.lab.bench.clock import Repeats
from render.lab.bench.scale.stage import CAMERA, FRAMES
from render.model.frame_settings import FrameSettings
from render.pictures.live_finisher import LiveFinisher
from render.pictures.picture import expose_frame
from render.pictures.progressive import PreviewRequest
from render.pictures.progressive.renderer import ProgressiveRenderer
from render.shot import Shot

RAYS = 16
REPEATS = Repeats(1, most=3, enough_ms=10_000.0)
"""Pictures after the first, each of the next frame, in which the camera stands elsewhere."""
SKETCH_REPEATS = Repeats(2, most=5, enough_ms=5_000.0)
"""Pairs of sketches, each of another place of the camera; the first two sketches of a scene have no levels yet."""


def measure(stage: Path, width: int) -> dict[str, float]:
    """Open a stage and draw its first frames.

    Args:
        stage: file as `render.lab.bench.scale.stage.write_stage` makes it.
        width: picture width in pixels.

    Returns:
        ``open``: seconds until the scene is read; ``first``: until the first picture; ``frame``: median of the pictures after it;
        ``sketch``: median of sketches while dragging, with simpler levels of meshes; ``whole``: of such without; each by the
        wall's clock (``_s``) and by the processor's, of all threads (``_cpu_s``); ``memory_mb``: peak of resident memory before
        the sketches; ``drawn_triangles``: with instances.
    """
    settings = FrameSettings(width, round(width * 9 / 16), rays=RAYS)
    clocks = [_now()]
    shot = Shot.open(stage)
    triangles = shot.scene_at(FRAMES[0]).triangle_count
    clocks.append(_now())
    with FrameRenderer() as renderer:
        while len(clocks) < 4 or REPEATS.more(len(clocks) - 3, 1000 * (clocks[-1][0] - clocks[2][0])):
            time = FRAMES[0] + len(clocks) - 2
            camera = shot.camera_at(CAMERA, time, settings.width, settings.height)
            expose_frame(renderer, shot, CAMERA, camera, time, settings)
            clocks.append(_now())
        found = {
            "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6,
            "drawn_triangles": triangles,
            **_measure_sketches(renderer, shot, settings),
        }
    for unit, times in zip(("s", "cpu_s"), zip(*clocks, strict=True), strict=True):
        found[f"open_{unit}"], found[f"first_{unit}"] = times[1] - times[0], times[2] - times[0]
        found[f"frame_{unit}"] = median(after - before for before, after in pairwise(times[2:]))
    return found


def _measure_sketches(renderer: FrameRenderer, shot: Shot, settings: FrameSettings) -> dict[str, float]:
    """Times of sketches with and without levels, in turns."""
    driver, sketches = ProgressiveRenderer(renderer, shot, LiveFinisher(renderer)), renderer.device.peeler.sketches
    most_error_px = sketches.most_error_px
    times: dict[str, list[tuple[float, float]]] = {"sketch": [], "whole": []}
    began = perf_counter()
    for number in count():
        for turn, (name, error_px) in enumerate((("sketch", most_error_px), ("whole", 0.0))):
            sketches.most_error_px = error_px
            before = _now()
            next(driver.pictures(PreviewRequest(CAMERA, FRAMES[0] + number + (1 + turn) / 3, settings, is_moving=True)))
            after = _now()
            if number > 1:
                times[name].append((after[0] - before[0], after[1] - before[1]))
        sketches.maker.wait()
        if number == 1:
            began = perf_counter()
        if number > 1 and not SKETCH_REPEATS.more(number - 1, 1000 * (perf_counter() - began)):
            break
    return {
        f"{name}_{unit}": median(one[i] for one in spent)
        for name, spent in times.items()
        for i, unit in enumerate(("s", "cpu_s"))
    }


def _now() -> tuple[float, float]:
    return perf_counter(), process_time()


if __name__ == "__main__":
    Path(sys.argv[3]).write_text(json.dumps(measure(Path(sys.argv[1]), int(sys.argv[2]))))
