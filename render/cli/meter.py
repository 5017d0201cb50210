"""`pullfocus meter`: how a camera exposes, what a light meter says of its shot, and that as keys of its exposure."""

from __future__ import annotations

import argparse
import time as clock
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from render.cli import arguments as shared
from render.cli.exposure_numbers import meter_json, print_meter
from render.cli.report import FrameProgress, print_json, say, warn_of
from render.errors import CameraError, SettingsError
from render.files import check_writable, write_atomic
from render.model.frame_spec import every_frame, parse_frames
from render.shot import Shot
from render.shot.exposure.keys import compensation_stops, exposure_layer
from render.shot.exposure.metering import Metered
from render.shot.light_meter import LightMeter

MODES = ("spot", "center", "average")
KEY_SUFFIXES = (".usda", ".usd")
"""Endings under which the text of a layer is what USD takes it for."""
LEAST_S, MOST_S = 0.001, 3600.0
"""Of smoothing: below it nothing is smoothed, beyond it no light would ever be followed."""
MANUALLY = "center"
"""How is metered where neither the user nor the shot says it: as cameras do that are taken out of their box."""


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser(
        "meter", help="the exposure in EV, lux and stops as a light meter sees it; --key makes it keys of the camera"
    )
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    shared.add_camera(parser)
    shared.add_lens(parser)
    shared.add_frames(parser, "the shot's first frame, with --key every frame of the shot")
    parser.add_argument(
        "--mode", choices=MODES, help=f"what the meter looks at; without it what the shot says, else {MANUALLY}"
    )
    spot = parser.add_mutually_exclusive_group()
    spot.add_argument("--point", metavar="NAME", help="the focus point that a spot meter looks at")
    spot.add_argument(
        "--spot",
        metavar="X,Y",
        help="the place that a spot meter looks at: 0,0 is the top left corner, 1,1 the bottom right",
    )
    parser.add_argument(
        "--compensation", metavar="STOPS", type=float, help="expose so much more than the meter says; negative less"
    )
    parser.add_argument(
        "--smoothing", metavar="SECONDS", type=float, help="how long a sudden change of the light takes to be followed"
    )
    parser.add_argument("--shading", default="lit", choices=("lit", "unlit"), help="as for record")
    parser.add_argument(
        "--key", metavar="OUT.usda", type=Path, help="write a layer with the metered exposure, to put over the shot"
    )
    parser.add_argument("--hold", action="store_true", help="with --key: one exposure for all frames")
    parser.add_argument("--baked", action="store_true", help="with --key: time samples in place of native splines")
    parser.add_argument("--json", action="store_true", help="print it for programs")


def run(arguments: argparse.Namespace) -> None:
    """Meter the shot, print what the meter says, and write it as keys.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        SettingsError: the arguments do not fit together.
        InputError: the shot or its camera cannot be used, or is black where keys are wanted.
        GraphicsError: no OpenGL context.
        OutputError: the layer cannot be written.
    """
    asked = _asked(arguments)
    if arguments.key is not None:
        _check_key(arguments.key)
    frames = None if arguments.frames is None else sorted(parse_frames(arguments.frames))
    lens = shared.asked_lens(arguments.lens)
    shot = Shot.open(arguments.stage, edits=arguments.edits)
    if arguments.key is not None:
        shot.check_not_own(arguments.key)
    camera = shared.choose_camera(shot, arguments.camera)
    if camera is None:
        raise CameraError(f"{arguments.stage} has no camera to meter through: name one with --camera", code="no_camera")
    shared.mount(shot, camera, lens)
    start, end = shot.frame_range.start, shot.frame_range.end
    frames = frames or ([start] if arguments.key is None else every_frame(start, end))
    shot.exposure.read(camera, frames[0])  # it is a camera, and can be used
    if "mode" not in asked and shot.exposure.metering(camera, frames[0]).mode == "manual":
        asked["mode"] = MANUALLY
    said = _metered(shot, camera, frames, arguments.shading, asked)
    if arguments.key is not None:
        stops = compensation_stops(said, held=arguments.hold)
        write_atomic(arguments.key, exposure_layer(shot.stage, camera, frames, stops, baked=arguments.baked).encode())
        say(f"wrote {arguments.key}: exposure {stops.min():+.2f} to {stops.max():+.2f} stops over {len(frames)} frames")
    warn_of(shot.findings(), arguments.stage)
    if arguments.json:
        print_json({"stage": arguments.stage, "camera": camera, "frames": [meter_json(one) for one in said]})
    elif arguments.key is None:
        print_meter(said)


def _check_key(layer: Path) -> None:
    if layer.suffix.lower() not in KEY_SUFFIXES:
        raise SettingsError(f"--key writes a layer as text, a {' or '.join(KEY_SUFFIXES)} file, got {layer}")
    check_writable(layer)


def _asked(arguments: argparse.Namespace) -> dict[str, Any]:
    """What the user asks of the meter, in place of what the shot asks."""
    for option, is_given in (("--hold", arguments.hold), ("--baked", arguments.baked)):
        if is_given and arguments.key is None:
            raise SettingsError(f"{option} is for --key, which writes the exposure")
    asked = {"mode": arguments.mode, "compensation_stops": shared.compensation(arguments.compensation)}
    asked["smoothing_s"] = shared.number_within("--smoothing", arguments.smoothing, LEAST_S, MOST_S, "seconds")
    if arguments.point is not None:
        asked["focus_point"] = arguments.point
    if arguments.spot is not None:
        asked |= {"focus_point": "", "spot": shared.place("--spot", arguments.spot)}
    if arguments.point is not None or arguments.spot is not None:
        if arguments.mode not in (None, "spot"):
            raise SettingsError(f"--point and --spot are for --mode spot, got {arguments.mode}")
        asked["mode"] = "spot"
    return {name: value for name, value in asked.items() if value is not None}


def _metered(shot: Shot, camera: str, frames: Sequence[float], shading: str, asked: dict[str, Any]) -> list[Metered]:
    from render.frame import FrameRenderer  # imports OpenGL, which takes seconds: not before the shot is found good

    said = []
    with FrameRenderer() as renderer, FrameProgress(len(frames)) as progress:
        meter = LightMeter(renderer, shot, camera, shading, **asked)
        for frame in frames:
            began = clock.perf_counter()
            progress.begin(f"frame {frame:g}")
            said.append(meter.read(frame))
            progress.finish(f"frame {frame:g}", clock.perf_counter() - began)
    return said
