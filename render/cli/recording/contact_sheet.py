"""Record several pictures on one contact sheet."""

from __future__ import annotations

import time as clock
from dataclasses import replace
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress
from render.cli.recording.job import RecordJob
from render.files import write_atomic
from render.pictures.contact_axes import Axis


def record_contact_sheet(job: RecordJob, axes: tuple[Axis, ...], time: float, file: Path) -> list[dict[str, Any]]:
    """Render the pictures, draw the sheet and write it.

    Args:
        job: the shot, its camera and the settings of each picture.
        axes: one or two things that vary over the sheet, such as lenses or frames.
        time: USD time code of the pictures, unless frames are an axis.
        file: image file to write.

    Returns:
        One entry for ``--json``.
    """
    from render.drawing.contact_sheet import draw_contact_sheet  # matplotlib takes a second to load
    from render.frame import FrameRenderer  # loads OpenGL, which takes seconds: only once the shot is checked
    from render.pictures.contact_sheet import make_contact_sheet

    start = clock.perf_counter()
    with FrameRenderer() as renderer, FrameProgress(1) as progress:

        def show_progress(name: str, share: float) -> None:
            progress.begin(name)
            progress.update(share)

        progress.begin(file.name)
        sheet = make_contact_sheet(
            renderer,
            job.shot,
            job.camera_path,
            time,
            job.settings,
            axes,
            stock=job.stock,
            choice=job.grade,
            on_picture=show_progress,
        )
        pictures = (
            replace(picture, graded=job.overlay(picture.graded, picture.metadata)) for picture in sheet.pictures
        )
        sheet = replace(sheet, pictures=tuple(pictures))
        write_atomic(file, draw_contact_sheet(sheet, file.suffix.lower().removeprefix(".")))
        seconds = clock.perf_counter() - start
        progress.finish(f"{file}, {len(sheet.pictures)} pictures,", seconds)
    compared = {axis.name: [choice.label for choice in axis.choices] for axis in axes}
    return [{"time": time, "file": str(file), "seconds": round(seconds, 3), "contactSheet": compared}]
