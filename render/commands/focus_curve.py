"""`pullfocus focus-curve`: the solved focus over time, for programs, for spreadsheets and as a layer for USD tools."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.commands import arguments as shared
from render.errors import CameraError, SettingsError
from render.files import write_atomic
from render.focus import curve_to_csv, curve_to_json
from render.frame_spec import every_frame, parse_frames
from render.shot import Shot

FORMATS = ("json", "csv", "usda")
FORMATS_TO_COME = ("otio", "opentrackio")


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser("focus-curve", help="write the solved focus over time as json, csv or a USD layer")
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    shared.add_camera(parser)
    shared.add_lens(parser)
    shared.add_frames(parser, "every frame of the shot")
    parser.add_argument(
        "--format", default="json", choices=(*FORMATS, *FORMATS_TO_COME), help="usda is a layer to put over the shot"
    )
    parser.add_argument(
        "--baked", action="store_true", help="time samples in place of a native spline, for tools that read none (usda)"
    )
    parser.add_argument("--out", metavar="FILE", type=Path, help="where to; without it, standard output")


def run(arguments: argparse.Namespace) -> None:
    """Solve the focus and write the curve.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the arguments do not fit together.
        InputError: the shot or its camera cannot be used.
        OutputError: the file cannot be written.
    """
    if arguments.format in FORMATS_TO_COME:
        raise SettingsError(
            f"format {arguments.format} comes later; use one of {', '.join(FORMATS)}", code="comes_later"
        )
    if arguments.baked and arguments.format != "usda":
        raise SettingsError(f"--baked is for --format usda alone, got {arguments.format}")
    asked = None if arguments.frames is None else sorted(parse_frames(arguments.frames))
    lens = shared.asked_lens(arguments.lens)
    shot = Shot.open(arguments.stage, edits=arguments.edits)
    if arguments.out is not None:
        shot.check_not_own(arguments.out)
    camera = shared.choose_camera(shot, arguments.camera)
    if camera is None:
        raise _no_camera(arguments.stage, shot.cameras())
    shared.mount(shot, camera, lens)
    frames = asked or every_frame(shot.frame_range.start, shot.frame_range.end)
    text = _text(shot, camera, frames, arguments)
    if arguments.out is None:
        sys.stdout.write(text)
    else:
        write_atomic(arguments.out, text.encode())


def _no_camera(stage: str, cameras: Sequence[str]) -> CameraError:
    if cameras:
        return CameraError(f"{stage} has {len(cameras)} cameras; name one with --camera: {', '.join(cameras)}")
    return CameraError(f"{stage} has no camera, and so no focus to pull; give it one with a layer over it")


def _text(shot: Shot, camera: str, frames: Sequence[float], arguments: argparse.Namespace) -> str:
    if arguments.format == "usda":
        return shot.focus_layer(camera, frames, baked=arguments.baked)
    curve = shot.focus_curve(camera, frames)
    return curve_to_csv(curve) if arguments.format == "csv" else curve_to_json(curve)
