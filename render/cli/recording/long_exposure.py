"""Record one picture that is exposed over many frames."""

from __future__ import annotations

import time as clock
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress, print_message
from render.cli.options.long_exposure import LongExposureOptions
from render.cli.recording.job import RecordJob
from render.output import write_frame
from render.pictures.long_exposure import LongExposure, LongExposureState


def record_long_exposure(job: RecordJob, options: LongExposureOptions, file: Path) -> list[dict[str, Any]]:
    """Expose and write the picture.

    Args:
        job: how each interval is rendered.
        options: when the shutter is open, and the filter.
        file: to write.

    Returns:
        For --json, one entry.

    Raises:
        KeyboardInterrupt: it was stopped; the exposure until then is written.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    start = clock.perf_counter()
    intervals = options.intervals
    with FrameRenderer() as renderer, FrameProgress(len(intervals)) as progress:
        exposure = LongExposure(
            renderer,
            job.shot,
            job.camera_path,
            options.begin,
            job.settings,
            nd_stops=options.nd_stops,
            stock=job.stock,
            choice=job.grade,
        )
        try:
            for begin, end in intervals:
                interval_start = clock.perf_counter()
                progress.begin(f"frame {begin:g}")
                exposure.expose(begin, end, progress.update)
                progress.finish(f"exposed to frame {end:g}", clock.perf_counter() - interval_start)
        except KeyboardInterrupt:
            if exposure.state.intervals:
                _write(job, exposure, file)
                print_message(f"stopped: {file} holds {_duration(exposure.state)} of the exposure")
            raise
        _write(job, exposure, file)
        state = exposure.state
    print_message(f"{file}: {_duration(state)} with {state.nd_stops:.1f} stops of neutral density")
    seconds = round(clock.perf_counter() - start, 3)
    return [{"time": options.begin, "file": str(file), "seconds": seconds, "longExposure": _state_json(state)}]


def _write(job: RecordJob, exposure: LongExposure, file: Path) -> None:
    picture = exposure.develop()
    write_frame(file, picture.frame, job.overlay(picture.graded, picture.metadata), picture.metadata)


def _duration(state: LongExposureState) -> str:
    return f"{state.open_seconds:.4g} s ({state.open_frames:g} frame{'' if state.open_frames == 1 else 's'})"


def _state_json(state: LongExposureState) -> dict[str, Any]:
    return {
        "openFrames": state.open_frames,
        "openSeconds": state.open_seconds,
        "intervals": state.intervals,
        "ndStops": state.nd_stops,
    }
