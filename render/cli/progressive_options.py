"""The option of `record` that shows a picture while it becomes better, and how that goes."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from render.cli.camera_options import Viewed
from render.cli.report import FrameProgress, camel_case_keys, say
from render.errors import OutputError, SettingsError
from render.files import write_atomic
from render.film import GradeChoice
from render.model.frame_settings import FrameSettings
from render.output import format_of, write_frame
from render.output.encode import encode_jpeg, encode_png
from render.pictures.progressive import PreviewRequest, Shown
from render.shot import Shot


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare it, for `check`."""
    parser.add_argument(
        "--progressive",
        action="store_true",
        help="write a first picture at once and better ones over it, for a viewer that reloads the file; the last one is the"
        " same as without it",
    )


def check(arguments: argparse.Namespace) -> None:
    """See that it goes with the rest.

    Args:
        arguments: as `add_arguments` declares it, and those of `record`.

    Raises:
        SettingsError: it does not.
    """
    if not arguments.progressive:
        return
    if format_of(arguments.out) == "exr":
        raise SettingsError(f"--progressive is for pictures to look at: OUT must be .png or .jpg, got {arguments.out}")
    for name in ("long_exposure", "contact_sheet"):
        if getattr(arguments, name):
            raise SettingsError(f"--progressive is for single frames: leave out --{name.replace('_', '-')}")


def record_progressively(
    shot: Shot,
    camera: str | None,
    plan: Sequence[tuple[float, Path]],
    settings: FrameSettings,
    stock: str | None,
    grade: GradeChoice | None,
    viewed: Viewed,
) -> list[dict[str, Any]]:
    """Render each frame of the plan, and write each picture of it over the one before; what was written, for --json.

    Args:
        shot: the shot.
        camera: prim path; None for one that frames the whole stage.
        plan: times and files.
        settings: how each frame is rendered in the end.
        stock: a film of the library, or None for the shot's own.
        grade: what is wanted in place of the shot's own.
        viewed: what is drawn over a graded picture.
    """
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: not before the shot is found good
    from render.pictures.live_finisher import LiveFinisher
    from render.pictures.progressive.driver import Progressive

    written = []
    with FrameRenderer() as renderer, FrameProgress(len(plan)) as progress:
        driver = Progressive(renderer, shot, LiveFinisher(renderer))
        for time, file in plan:
            progress.begin(file.name)
            pictures = []
            with _kept_unless_final(file):
                for shown in driver.pictures(PreviewRequest(camera, time, settings, stock=stock, choice=grade)):
                    _write(file, shown, settings, viewed)
                    pictures.append(_record(shown))
                    if not shown.is_final:
                        progress.within(shown.share)
                        height, width, _ = shown.graded.shape
                        say(f"{file}: {shown.stage} of {width} x {height} after {shown.timing.total_ms / 1000:.2f} s")
            seconds = pictures[-1]["totalMs"] / 1000
            progress.finish(str(file), seconds)
            written.append({"time": time, "file": str(file), "seconds": round(seconds, 3), "pictures": pictures})
    return written


@contextmanager
def _kept_unless_final(file: Path) -> Iterator[None]:
    """Put back what was in the file, or nothing, where no final picture comes: a preview is not what was asked for."""
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


def _write(file: Path, shown: Shown, settings: FrameSettings, viewed: Viewed) -> None:
    from render.pictures.progressive.frames import enlarged

    if shown.picture is not None:
        picture = shown.picture
        write_frame(file, picture.frame, viewed(picture.graded, picture.camera), picture.metadata)
        return
    graded = viewed(enlarged(shown.graded, settings.width, settings.height), shown.metadata.camera)
    encode = encode_png if format_of(file) == "png" else encode_jpeg
    write_atomic(file, encode(graded, shown.metadata))


def _record(shown: Shown) -> dict[str, Any]:
    height, width, _ = shown.graded.shape
    timing = {name: round(spent, 1) for name, spent in asdict(shown.timing).items()}
    said = {"stage": shown.stage, "width": width, "height": height, "rays": shown.rays, "share": round(shown.share, 3)}
    return camel_case_keys(said | timing)
