"""Record both eyes of a stereo pair."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from render.cli.console import FrameProgress
from render.cli.recording.job import RecordJob
from render.output import write_frame, write_views
from render.output.layout import PLAIN_LAYOUT, FileLayout
from render.pictures.stereo import make_stereo_pictures
from render.stage import EYES, Eye, StereoPair

if TYPE_CHECKING:  # it imports OpenGL
    from render.frame import FrameRenderer

EyeFiles = Mapping[Eye, Path]
"""File of each eye; one for both where it holds both."""


def record_stereo_frames(
    job: RecordJob, pair: StereoPair, plan: Sequence[tuple[float, EyeFiles]]
) -> list[dict[str, Any]]:
    """Render and write both eyes of each frame.

    Args:
        job: the shot and the settings of each picture.
        pair: cameras of both eyes.
        plan: USD time code and output files of each frame.

    Returns:
        Entries for ``--json``, one for each file.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    written = []
    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        for time, files in plan:
            written += record_stereo_frame(renderer, progress, job, pair, time, files)
    return written


def record_stereo_frame(
    renderer: FrameRenderer,
    progress: FrameProgress,
    job: RecordJob,
    pair: StereoPair,
    time: float,
    files: EyeFiles,
    layout: FileLayout = PLAIN_LAYOUT,
) -> list[dict[str, Any]]:
    """Render and write both eyes of one frame.

    Args:
        renderer: of the calling thread.
        progress: shows it.
        job: the shot and the settings of each picture.
        pair: cameras of both eyes.
        time: USD time code.
        files: output files.
        layout: parts of an EXR file, and its place in a larger picture.

    Returns:
        Entries for ``--json``, one for each file.
    """
    start = clock.perf_counter()
    names = list(dict.fromkeys(files.values()))
    progress.begin(names[0].name)
    pictures = make_stereo_pictures(
        renderer, job.shot, pair, time, job.settings, progress.update, stock=job.stock, choice=job.grade
    )
    if len(names) == 1:
        write_views(names[0], [(picture.frame, picture.metadata) for picture in pictures.values()], layout)
    else:
        for eye, picture in pictures.items():
            graded = job.overlay(picture.graded, picture.metadata)
            write_frame(files[eye], picture.frame, graded, picture.metadata, layout)
    seconds = clock.perf_counter() - start
    progress.finish(" and ".join(map(str, names)), seconds)
    entry = {"time": time, "seconds": round(seconds, 3)}
    return [{**entry, "file": str(name), "views": [eye for eye in EYES if files[eye] == name]} for name in names]
