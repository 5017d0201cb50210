"""One case of the scale bench, in a process of its own: opens a stage, draws pictures and writes what that took.

python -m render.lab.bench.scale.case STAGE WIDTH FILE
"""

from __future__ import annotations

import json
import resource
import sys
from itertools import pairwise
from pathlib import Path
from time import perf_counter

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
        ``open_s``: seconds until the scene is read; ``first_s``: until the first picture; ``frame_s``: median of the
        pictures after it; ``memory_mb``: peak of resident memory; ``drawn_triangles``: with instances.
    """
    settings = FrameSettings(width, round(width * 9 / 16), rays=RAYS)
    began = perf_counter()
    shot = Shot.open(stage)
    triangles = shot.scene_at(FRAMES[0]).triangle_count
    opened = perf_counter()
    ends = [opened]
    with FrameRenderer() as renderer:
        while len(ends) < 2 or REPEATS.more(len(ends) - 2, 1000 * (ends[-1] - ends[1])):
            time = FRAMES[0] + len(ends) - 1
            camera = shot.camera_at(CAMERA, time, settings.width, settings.height)
            expose_frame(renderer, shot, CAMERA, camera, time, settings)
            ends.append(perf_counter())
    frames = sorted(after - before for before, after in pairwise(ends[1:]))
    return {
        "open_s": opened - began,
        "first_s": ends[1] - began,
        "frame_s": frames[len(frames) // 2],
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6,
        "drawn_triangles": triangles,
    }


if __name__ == "__main__":
    Path(sys.argv[3]).write_text(json.dumps(measure(Path(sys.argv[1]), int(sys.argv[2]))))
