"""The options of `record` that put several pictures on one sheet to compare them."""

from __future__ import annotations

import argparse
import time as clock
from dataclasses import replace
from pathlib import Path
from typing import Any

from render.cli.arguments import split_words
from render.cli.camera_options import Viewed
from render.cli.report import FrameProgress
from render.errors import SettingsError
from render.files import write_atomic
from render.film import GradeChoice
from render.model.frame_settings import FrameSettings
from render.model.frame_spec import parse_frames
from render.pictures.contact_axes import AXES, EXAMPLES, Axis, parse_axes
from render.shot import Shot

SUFFIXES = (".png", ".svg")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare them, for `asked_axes`."""
    group = parser.add_argument_group("a contact sheet")
    group.add_argument(
        "--contact-sheet",
        metavar="WHAT=A,B,C",
        action="append",
        help=f"compare {', '.join(AXES)} in one labelled picture, a .png or .svg file: such as stock={EXAMPLES['stock']},"
        f" stop={EXAMPLES['stop']} or lens={EXAMPLES['lens']}; given twice, columns and rows",
    )


def asked_axes(arguments: argparse.Namespace) -> tuple[Axis, ...] | None:
    """What the options ask to compare, if anything.

    Args:
        arguments: as `add_arguments` declares them, and those of other options that do not go with them.

    Raises:
        SettingsError: they cannot be read, or do not go together.
        InputError: a lens file is none.
    """
    if arguments.contact_sheet is None:
        return None
    if Path(arguments.out).suffix.lower() not in SUFFIXES:
        raise SettingsError(f"a contact sheet is a {' or '.join(SUFFIXES)} file, got {arguments.out}")
    axes = parse_axes(arguments.contact_sheet)
    for option, name in (("film", "stock"), ("lens", "lens"), ("frames", "frame"), ("stop", "stop")):
        if getattr(arguments, option) is not None and any(axis.name == name for axis in axes):
            raise SettingsError(f"--{option} and a contact sheet of {name}s are one too many: leave out --{option}")
    if arguments.long_exposure is not None:
        raise SettingsError("a contact sheet has no long exposures: leave out --long-exposure")
    if split_words(arguments.aov) != ("color",):
        raise SettingsError("a contact sheet has pictures alone: leave out --aov")
    if arguments.frames is not None and len(parse_frames(arguments.frames)) > 1:
        raise SettingsError(
            f"a contact sheet is of one frame, got --frames {arguments.frames}; frames are compared by"
            f" --contact-sheet frame={EXAMPLES['frame']}"
        )
    return axes


def record_contact_sheet(
    shot: Shot,
    camera: str | None,
    axes: tuple[Axis, ...],
    time: float,
    file: Path,
    settings: FrameSettings,
    stock: str | None,
    grade: GradeChoice | None,
    viewed: Viewed,
) -> list[dict[str, Any]]:
    """Take the pictures and draw the sheet; what was written, for --json.

    Args:
        shot: the shot.
        camera: prim path; None for one that frames the whole stage.
        axes: what is compared.
        time: USD time code, where frames are not compared.
        file: to write.
        settings: how each picture is rendered.
        stock: a film of the library, or None for the shot's own.
        grade: what is wanted in place of the shot's own.
        viewed: what is drawn over a graded picture.
    """
    from render.drawing.contact_sheet import draw_contact_sheet  # matplotlib takes a second to load
    from render.frame import FrameRenderer  # and OpenGL several: not before the shot is found good
    from render.pictures.contact_sheet import make_contact_sheet

    began = clock.perf_counter()
    with FrameRenderer() as renderer, FrameProgress(1) as progress:

        def at_work(name: str, share: float) -> None:
            progress.begin(name)
            progress.within(share)

        progress.begin(file.name)
        sheet = make_contact_sheet(
            renderer, shot, camera, time, settings, axes, stock=stock, choice=grade, on_picture=at_work
        )
        seen = tuple(replace(picture, graded=viewed(picture.graded, picture.camera)) for picture in sheet.pictures)
        sheet = replace(sheet, pictures=seen)
        write_atomic(file, draw_contact_sheet(sheet, file.suffix.lower().removeprefix(".")))
        seconds = clock.perf_counter() - began
        progress.finish(f"{file}, {len(sheet.pictures)} pictures,", seconds)
    compared = {axis.name: [choice.label for choice in axis.choices] for axis in axes}
    return [{"time": time, "file": str(file), "seconds": round(seconds, 3), "contactSheet": compared}]
