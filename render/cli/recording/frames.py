"""Record single frames to files."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from render.cli.console import FrameProgress
from render.cli.recording.job import RecordJob
from render.output import write_frame
from render.output.layout import PLAIN_LAYOUT, FileLayout
from render.pictures.picture import Picture, make_picture

if TYPE_CHECKING:  # it imports OpenGL
    from render.frame import FrameRenderer


def record_frames(job: RecordJob, plan: Sequence[tuple[float, Path]]) -> list[dict[str, Any]]:
    """Render and write each frame.

    Args:
        job: the shot, its camera and the settings of each picture.
        plan: USD time code and output file of each frame.

    Returns:
        Entries for ``--json``, one for each file.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        return [record_frame(renderer, progress, job, time, file) for time, file in plan]


def record_frame(
    renderer: FrameRenderer,
    progress: FrameProgress,
    job: RecordJob,
    time: float,
    file: Path,
    layout: FileLayout = PLAIN_LAYOUT,
) -> dict[str, Any]:
    """Render and write one frame.

    Args:
        renderer: of the calling thread.
        progress: shows it.
        job: the shot, its camera and the settings of the picture.
        time: USD time code.
        file: output file.
        layout: parts of an EXR file, and its place in a larger picture.

    Returns:
        Entry for ``--json``.
    """
    start = clock.perf_counter()
    progress.begin(file.name)
    picture = draw_picture(renderer, progress, job, time)
    write_frame(file, picture.frame, job.overlay(picture.graded, picture.metadata), picture.metadata, layout)
    seconds = clock.perf_counter() - start
    progress.finish(str(file), seconds)
    return {"time": time, "file": str(file), "seconds": round(seconds, 3)}


def draw_picture(renderer: FrameRenderer, progress: FrameProgress, job: RecordJob, time: float) -> Picture:
    """Render one frame.

    Args:
        renderer: of the calling thread.
        progress: shows it.
        job: the shot, its camera and the settings of the picture.
        time: USD time code.
    """
    return make_picture(
        renderer,
        job.shot,
        job.camera_path,
        time,
        job.settings,
        on_progress=progress.update,
        stock=job.stock,
        choice=job.grade,
    )
