"""`pullfocus meter`: exposure of a camera, readings of a light meter, and keys that expose the camera as metered."""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.cli.console import FrameProgress, print_json, print_message
from render.cli.options import shared
from render.cli.tables.exposure import meter_json, print_readings
from render.errors import CameraError, SettingsError
from render.files import check_writable, write_atomic
from render.model.frame_spec import every_frame, parse_frames
from render.shot import Shot
from render.shot.exposure.keys import compensation_stops, exposure_layer
from render.shot.exposure.metering import Metered
from render.shot.light_meter import LightMeter

MODES = ("spot", "center", "average")
KEY_SUFFIXES = (".usda", ".usd")
"""Suffixes of layers that hold usda text."""
LEAST_S, MOST_S = 0.001, 3600.0
"""Range of smoothing: below it nothing is smoothed, beyond it no change of light is followed."""
DEFAULT_MODE = "center"
"""Metering mode where neither the user nor the shot sets one, the factory default of most cameras."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    shared.add_camera(parser)
    shared.add_lens(parser)
    shared.add_frames(parser, "the shot's first frame, with --key every frame of the shot")
    parser.add_argument("--mode", choices=MODES, help=f"metering mode; without it the shot's, else {DEFAULT_MODE}")
    spot = parser.add_mutually_exclusive_group()
    spot.add_argument("--point", metavar="NAME", help="focus point to meter")
    spot.add_argument(
        "--spot",
        metavar="X,Y",
        help="place to meter: 0,0 is the top left corner, 1,1 the bottom right",
    )
    parser.add_argument("--compensation", metavar="STOPS", type=float, help="stops added to the reading")
    parser.add_argument(
        "--smoothing", metavar="SECONDS", type=float, help="time over which a sudden change of light is followed"
    )
    parser.add_argument("--shading", default="lit", choices=("lit", "unlit"), help="as for record")
    parser.add_argument(
        "--key",
        metavar="OUT.usda",
        type=Path,
        help="write a layer with the metered exposure, to sublayer over the shot",
    )
    parser.add_argument("--hold", action="store_true", help="with --key: one exposure for all frames")
    parser.add_argument("--baked", action="store_true", help="with --key: time samples in place of native splines")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(arguments: argparse.Namespace) -> None:
    """Meter the shot, and print the readings or write them as keys.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        SettingsError: the arguments do not fit together.
        InputError: the shot or its camera cannot be used, or is black where keys are to be written.
        GraphicsError: no OpenGL context.
        OutputError: the layer cannot be written.
    """
    changes = _metering_changes(arguments)
    if arguments.key is not None:
        _check_key(arguments.key)
    frames = None if arguments.frames is None else sorted(parse_frames(arguments.frames))
    lens = shared.read_lens(arguments)
    shot = shared.open_shot(arguments)
    if arguments.key is not None:
        shot.check_not_own(arguments.key)
    with shared.printed_findings(shot, arguments.stage):
        camera = shared.choose_camera(shot, arguments.camera)
        if camera is None:
            raise CameraError(
                f"{arguments.stage} has no camera to meter through: name one with --camera", code="no_camera"
            )
        shared.mount_lens(shot, camera, lens)
        start, end = shot.frame_range.start, shot.frame_range.end
        frames = frames or ([start] if arguments.key is None else every_frame(start, end))
        shot.exposure.read(camera, frames[0])  # raises where the camera cannot be used
        if "mode" not in changes and shot.exposure.metering(camera, frames[0]).mode == "manual":
            changes["mode"] = DEFAULT_MODE
        readings = _read_meter(shot, camera, frames, arguments.shading, changes)
    if arguments.key is not None:
        stops = compensation_stops(readings, held=arguments.hold)
        write_atomic(arguments.key, exposure_layer(shot.stage, camera, frames, stops, baked=arguments.baked).encode())
        print_message(
            f"wrote {arguments.key}: exposure {stops.min():+.2f} to {stops.max():+.2f} stops over {len(frames)} frames"
        )
    if arguments.json:
        print_json(
            {"stage": arguments.stage, "camera": camera, "frames": [meter_json(metered) for metered in readings]}
        )
    elif arguments.key is None:
        print_readings(readings)


def _check_key(layer: Path) -> None:
    if layer.suffix.lower() not in KEY_SUFFIXES:
        raise SettingsError(f"--key writes a layer as text, a {' or '.join(KEY_SUFFIXES)} file, got {layer}")
    check_writable(layer)


def _metering_changes(arguments: argparse.Namespace) -> dict[str, Any]:
    """Read metering settings that replace the shot's, by the fields of `Metering`."""
    for option, is_given in (("--hold", arguments.hold), ("--baked", arguments.baked)):
        if is_given and arguments.key is None:
            raise SettingsError(f"{option} is for --key, which writes the exposure")
    changes = {"mode": arguments.mode, "compensation_stops": shared.check_compensation(arguments.compensation)}
    changes["smoothing_s"] = shared.check_number("--smoothing", arguments.smoothing, LEAST_S, MOST_S, "seconds")
    if arguments.point is not None:
        changes["focus_point"] = arguments.point
    if arguments.spot is not None:
        changes |= {"focus_point": "", "spot": shared.read_place("--spot", arguments.spot)}
    if arguments.point is not None or arguments.spot is not None:
        if arguments.mode not in (None, "spot"):
            raise SettingsError(f"--point and --spot are for --mode spot, got {arguments.mode}")
        changes["mode"] = "spot"
    return {name: value for name, value in changes.items() if value is not None}


def _read_meter(
    shot: Shot, camera: str, frames: Sequence[float], shading: str, changes: dict[str, Any]
) -> list[Metered]:
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: only once the shot is checked

    readings = []
    with FrameRenderer() as renderer, FrameProgress(len(frames)) as progress:
        meter = LightMeter(renderer, shot, camera, shading, **changes)
        for frame in frames:
            start = clock.perf_counter()
            progress.begin(f"frame {frame:g}")
            readings.append(meter.read(frame))
            progress.finish(f"frame {frame:g}", clock.perf_counter() - start)
    return readings
