"""`pullfocus focus-curve`: write the solved focus over time for other tools, or as a USD layer.

With ``--import`` the curve is read from a file of another tool, and becomes a layer over the shot.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from render.cli.console import print_message
from render.cli.options import shared
from render.errors import CameraError, InputError, SettingsError
from render.files import check_writable, write_atomic
from render.focus.files import FORMATS, GAPS, ReadCurve, curve_to_text
from render.model.frame_spec import every_frame, parse_frames
from render.shot import Shot
from render.shot.focus.curve_import import read_for_shot
from render.shot.focus.curve_layer import curve_layer
from usd_schemas.curves import EXACT
from usd_schemas.settings.tables import EXPOSURE_SETTINGS

LAYER = "usda"
MAX_WARNINGS = 8
_MAX_FILE_BYTES = 1 << 30


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    shared.add_camera(parser)
    shared.add_lens(parser)
    shared.add_frames(parser, "every frame of the shot")
    parser.add_argument(
        "--format",
        choices=(*FORMATS, LAYER),
        help="what to write: json (without --import, what is written), csv, otio for editorial, opentrackio for the set,"
        " or usda, a layer to put over the shot (with --import, what is written)",
    )
    parser.add_argument(
        "--baked", action="store_true", help="time samples in place of native splines, for tools that read none (usda)"
    )
    parser.add_argument(
        "--import",
        dest="source",
        metavar="FILE",
        type=Path,
        help="read the focus from a csv, json, opentrackio or otio file in place of solving it",
    )
    parser.add_argument(
        "--tolerance",
        metavar="SHARE",
        type=float,
        default=EXACT,
        help="largest relative error of splines (usda): 0.001 gives a curve of few keys that is easy to edit;"
        " without it they are exact at each frame",
    )
    parser.add_argument(
        "--gaps",
        choices=GAPS,
        help="with --import: treatment of missing or unusable rows; without it they are refused",
    )
    parser.add_argument(
        "--first-frame",
        metavar="TIME",
        type=float,
        help="with --import: time code of the file's first frame; without it frame numbers are kept,"
        " and a file with timecode begins at the first frame of the shot",
    )
    circle = EXPOSURE_SETTINGS["circle_distance"]
    parser.add_argument(
        "--circle-distance",
        choices=circle.choices,
        help="distance by which circles of confusion, limits and stops are computed, in place of the shot's",
    )
    parser.add_argument("--out", metavar="FILE", type=Path, help="file to write; without it, standard output")


def run(arguments: argparse.Namespace) -> None:
    """Solve the focus, or read a curve, and write it.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the arguments do not fit together.
        InputError: the shot, its camera or the file to import cannot be used.
        OutputError: the file cannot be written.
    """
    format = arguments.format or (LAYER if arguments.source else "json")
    _check_options(arguments, format)
    frames = None if arguments.frames is None else sorted(parse_frames(arguments.frames))
    lens = shared.read_lens(arguments)
    shot = shared.open_shot(arguments)
    if arguments.out is not None:
        shot.check_not_own(arguments.out)
        check_writable(arguments.out)
    with shared.printed_findings(shot, arguments.stage):
        camera = shared.choose_camera(shot, arguments.camera)
        if camera is None:
            raise _no_camera(arguments.stage, shot.cameras())
        if arguments.source is not None:
            text = _import_curve(shot, camera, format, arguments)
        else:
            shared.mount_lens(shot, camera, lens)
            if arguments.circle_distance is not None:
                shot.exposure.set(camera, circle_distance=arguments.circle_distance)
            frames = frames or every_frame(shot.frame_range.start, shot.frame_range.end)
            text = _solve_curve(shot, camera, frames, format, arguments)
    if arguments.out is None:
        sys.stdout.write(text)
    else:
        write_atomic(arguments.out, text.encode())


def _check_options(arguments: argparse.Namespace, format: str) -> None:
    if arguments.baked and format != LAYER:
        raise SettingsError(f"--baked is for --format usda alone, got {format}")
    import_options = {"--gaps": arguments.gaps, "--first-frame": arguments.first_frame}
    solve_options = {"--frames": arguments.frames, "--lens": arguments.lens}
    solve_options["--circle-distance"] = arguments.circle_distance
    misplaced = solve_options if arguments.source else import_options
    for option, value in misplaced.items():
        if value is not None:
            word = "not for" if arguments.source else "for"
            raise SettingsError(
                f"{option} is {word} --import, which {'takes' if arguments.source else 'reads'} a curve"
            )


def _no_camera(stage: str, cameras: Sequence[str]) -> CameraError:
    if cameras:
        return CameraError(f"{stage} has {len(cameras)} cameras; name one with --camera: {', '.join(cameras)}")
    return CameraError(f"{stage} has no camera, and so no focus to pull; give it one with a layer over it")


def _solve_curve(shot: Shot, camera: str, frames: Sequence[float], format: str, arguments: argparse.Namespace) -> str:
    if format == LAYER:
        return shot.focus.layer(camera, frames, baked=arguments.baked, tolerance=arguments.tolerance)
    curve = shot.focus.curve(camera, frames, distortion=format == "opentrackio")
    return curve_to_text(curve, format)  # type: ignore[arg-type]


def _import_curve(shot: Shot, camera: str, format: str, arguments: argparse.Namespace) -> str:
    shot.focus.read(camera, shot.frame_range.start)  # raises where the camera cannot be used
    read = read_for_shot(
        shot.stage,
        _read_file(arguments.source),
        gaps=arguments.gaps or "refuse",
        first_frame=arguments.first_frame,
    )
    _print_findings(read)
    if format == LAYER:
        comment = f"Focus of {camera}, from {arguments.source.name}, by Pullfocus: sublayer this over the shot."
        return curve_layer(
            shot.stage,
            camera,
            read.curve,
            read.given,
            baked=arguments.baked,
            comment=comment,
            tolerance=arguments.tolerance,
        )
    return curve_to_text(read.curve, format)  # type: ignore[arg-type]


def _print_findings(read: ReadCurve) -> None:
    for finding in read.findings[:MAX_WARNINGS]:
        print_message(f"warning: {finding.message}")
    if len(read.findings) > MAX_WARNINGS:
        print_message(f"warning: and {len(read.findings) - MAX_WARNINGS} more like these")


def _read_file(path: Path) -> bytes:
    """Read a file.

    Raises:
        InputError: it cannot be read, or is too large for a curve.
    """
    try:
        if path.stat().st_size > _MAX_FILE_BYTES:
            raise InputError(f"{path} has more than a gigabyte: it is no focus curve", code="bad_curve", path=str(path))
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}", code="unreadable", path=str(path)) from error
