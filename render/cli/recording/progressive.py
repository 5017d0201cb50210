"""Record frames progressively: a first picture at once, and better ones over it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress, camel_case_keys, print_message
from render.cli.recording.job import RecordJob
from render.errors import OutputError
from render.files import write_atomic
from render.output import format_of, write_frame
from render.output.encode import encode_jpeg, encode_png
from render.pictures.progressive import PreviewRequest, ProgressivePicture


def record_progressively(job: RecordJob, plan: Sequence[tuple[float, Path]]) -> list[dict[str, Any]]:
    """Render each frame, and write each picture of it over the one before.

    Args:
        job: how the final picture of a frame is rendered.
        plan: times and files.

    Returns:
        For --json, an entry for each file.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked
    from render.pictures.live_finisher import LiveFinisher
    from render.pictures.progressive.renderer import ProgressiveRenderer

    written = []
    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        driver = ProgressiveRenderer(renderer, job.shot, LiveFinisher(renderer))
        for time, file in plan:
            progress.begin(file.name)
            request = PreviewRequest(job.camera_path, time, job.settings, stock=job.stock, choice=job.grade)
            pictures = []
            with _restore_unless_final(file):
                for shown in driver.pictures(request):
                    _write(job, file, shown)
                    pictures.append(_picture_json(shown))
                    if not shown.is_final:
                        progress.update(shown.share)
                        _print_stage(file, shown)
            seconds = pictures[-1]["totalMs"] / 1000
            progress.finish(str(file), seconds)
            written.append({"time": time, "file": str(file), "seconds": round(seconds, 3), "pictures": pictures})
    return written


@contextmanager
def _restore_unless_final(file: Path) -> Iterator[None]:
    """Restore or remove the file where no final picture comes: a preview is no result."""
    before = file.read_bytes() if file.is_file() else None
    try:
        yield
    except BaseException:
        with suppress(OSError, OutputError):
            if before is None:
                file.unlink(missing_ok=True)
            else:
                write_atomic(file, before)
        raise


def _print_stage(file: Path, shown: ProgressivePicture) -> None:
    height, width, _ = shown.graded.shape
    print_message(f"{file}: {shown.stage} of {width} x {height} after {shown.timing.total_ms / 1000:.2f} s")


def _write(job: RecordJob, file: Path, shown: ProgressivePicture) -> None:
    from render.pictures.progressive.frames import enlarge

    if shown.picture is not None:
        picture = shown.picture
        write_frame(file, picture.frame, job.overlay(picture.graded, picture.metadata), picture.metadata)
        return
    graded = job.overlay(enlarge(shown.graded, job.settings.width, job.settings.height), shown.metadata)
    encode = encode_png if format_of(file) == "png" else encode_jpeg
    write_atomic(file, encode(graded, shown.metadata))


def _picture_json(shown: ProgressivePicture) -> dict[str, Any]:
    height, width, _ = shown.graded.shape
    record = {
        "stage": shown.stage,
        "width": width,
        "height": height,
        "rays": shown.rays,
        "share": round(shown.share, 3),
    }
    timing = {name: round(milliseconds, 1) for name, milliseconds in asdict(shown.timing).items()}
    return camel_case_keys(record | timing)
