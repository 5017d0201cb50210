"""Record single frames to files."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress
from render.cli.recording.job import RecordJob
from render.output import write_frame
from render.pictures.picture import make_picture


def record_frames(job: RecordJob, plan: Sequence[tuple[float, Path]]) -> list[dict[str, Any]]:
    """Render and write each frame.

    Args:
        job: the shot, its camera and the settings of each picture.
        plan: USD time code and output file of each frame.

    Returns:
        Entries for ``--json``, one for each file.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    written = []
    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        for time, file in plan:
            start = clock.perf_counter()
            progress.begin(file.name)
            picture = make_picture(
                renderer,
                job.shot,
                job.camera_path,
                time,
                job.settings,
                on_progress=progress.update,
                stock=job.stock,
                choice=job.grade,
            )
            write_frame(file, picture.frame, job.overlay(picture.graded, picture.camera), picture.metadata)
            seconds = clock.perf_counter() - start
            progress.finish(str(file), seconds)
            written.append({"time": time, "file": str(file), "seconds": round(seconds, 3)})
    return written
