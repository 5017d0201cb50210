"""One case of the scale bench, in a process of its own: opens a stage, draws pictures and writes what that took.

python -m render.lab.bench.scale.case STAGE WIDTH FILE
"""

from __future__ import annotations

import json
import resource
import sys
from itertools import pairwise
from pathlib import Path
from statistics import median
from time import perf_counter, process_time

from render.frame import FrameRenderer
from render.lab.bench.clock import Repeats
from render.lab.bench.scale.stage import CAMERA, FRAMES
from render.model.frame_settings import FrameSettings
from render.pictures.picture import expose_frame
from render.shot import Shot

RAYS = 16
REPEATS = Repeats(1, most=3, enough_ms=10_000.0)
"""Pictures after the first, each of the next frame, in which the camera stands elsewhere."""


def measure(stage: Path, width: int) -> dict[str, float]:
    """Open a stage and draw its first frames.

    Args:
        stage: file as `render.lab.bench.scale.stage.write_stage` makes it.
        width: picture width in pixels.

    Returns:
        ``open``: seconds until the scene is read; ``first``: until the first picture; ``frame``: median of the pictures after it;
        each by the wall's clock (``_s``) and by the processor's, of all threads (``_cpu_s``); ``memory_mb``: peak of resident
        memory; ``drawn_triangles``: with instances.
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
    }
    for unit, times in zip(("s", "cpu_s"), zip(*clocks, strict=True), strict=True):
        found[f"open_{unit}"], found[f"first_{unit}"] = times[1] - times[0], times[2] - times[0]
        found[f"frame_{unit}"] = median(after - before for before, after in pairwise(times[2:]))
    return found


def _now() -> tuple[float, float]:
    return perf_counter(), process_time()


if __name__ == "__main__":
    Path(sys.argv[3]).write_text(json.dumps(measure(Path(sys.argv[1]), int(sys.argv[2]))))
