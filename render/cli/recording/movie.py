"""Record frames to a movie."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress
from render.cli.recording.frames import draw_picture
from render.cli.recording.job import RecordJob
from render.output.encode import to_8_bit
from render.output.movie import describe_movie, movie_rate, open_movie


def record_movie(job: RecordJob, times: Sequence[float], file: Path) -> list[dict[str, Any]]:
    """Render each frame, and write them to one movie.

    Args:
        job: the shot, its camera and the settings of each picture.
        times: USD time codes.
        file: movie to write; it is there once all frames are.

    Returns:
        Entries for ``--json``, one for each frame.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    written = []
    description = None
    rate = movie_rate(times, job.shot.stage.GetTimeCodesPerSecond())
    with FrameRenderer() as renderer, FrameProgress(len(times)) as progress, open_movie(file, rate) as movie:
        for time in times:
            start = clock.perf_counter()
            name = f"{file.name}, frame {time:g}"
            progress.begin(name)
            picture = draw_picture(renderer, progress, job, time)
            graded = job.overlay(picture.graded, picture.metadata)
            description = description or describe_movie(picture.metadata, times, rate)
            movie.add(to_8_bit(graded), description)
            seconds = clock.perf_counter() - start
            progress.finish(name, seconds)
            written.append({"time": time, "file": str(file), "seconds": round(seconds, 3)})
    return written
