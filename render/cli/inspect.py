"""`pullfocus inspect`: what a shot holds, what of it is not honoured, and what is wrong with it."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from render.cli import arguments as shared
from render.cli.exposure_numbers import exposed_line, exposure_json
from render.cli.report import camel_case_keys, finite, print_json
from render.errors import one_line
from render.optics.photometry.exposure import ExposureSettings
from render.shot import Readout, Shot
from render.shot.inspection import Inspection, inspect_shot


def add_parser(commands: Any) -> None:
    """Declare the command's arguments."""
    parser = commands.add_parser("inspect", help="cameras, frame range, what is not honoured, validation findings")
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    parser.add_argument("--json", action="store_true", help="print it for programs")


def run(arguments: argparse.Namespace) -> None:
    """Read the shot at its first frame and print what is in it.

    Args:
        arguments: as `add_parser` declares them.

    Raises:
        StageError: it cannot be read.
    """
    found = inspect_shot(Shot.open(arguments.stage, edits=arguments.edits))
    if arguments.json:
        print_json({"stage": arguments.stage, **as_json(found)})
    else:
        print("\n".join(map(one_line, _lines(arguments.stage, found))))


def as_json(found: Inspection) -> dict[str, Any]:
    """What was found, under the names that the service uses too; an infinite distance is null.

    Args:
        found: what to write.
    """
    return {
        "frameRange": camel_case_keys(asdict(found.frame_range)),
        "upAxis": found.up_axis,
        "metersPerUnit": found.metres_per_unit,
        "cameras": list(found.cameras),
        "defaultCamera": {"path": found.default_camera.path, "reason": found.default_camera.reason},
        "readouts": [finite(camel_case_keys(asdict(readout))) for readout in found.readouts],
        "exposures": [{"camera": read.camera, **exposure_json(read)} for read in found.exposures],
        "primCount": found.prim_count,
        "triangleCount": found.triangle_count,
        "lightCount": found.light_count,
        "notes": [asdict(note) for note in found.notes],
        "validation": [asdict(problem) for problem in found.validation],
    }


def _lines(stage: str, found: Inspection) -> Iterator[str]:
    frames = found.frame_range
    yield stage
    yield f"  frames    {frames.start:g} to {frames.end:g}, {frames.frames_per_second:g} a second"
    yield f"  units     {found.metres_per_unit:g} m, {found.up_axis} up"
    yield (
        f"  drawn     {found.prim_count:,} prims, {found.triangle_count:,} triangles, {found.light_count:,} lights"
        f" at frame {frames.start:g}"
    )
    yield "cameras"
    default = found.default_camera
    exposed = {read.camera: exposed_line(read) for read in found.exposures if read.settings != ExposureSettings()}
    described = {readout.camera: _lens(readout) for readout in found.readouts}
    for path in found.cameras:
        yield f"  {path}  {described.get(path, 'cannot be used')}{' (default)' if path == default.path else ''}"
        if path in exposed:
            yield f"    exposed {exposed[path]}"
    yield f"  without --camera: {default.path or 'one that frames the stage'} ({default.reason})"
    yield from _section("not honoured", [note.message for note in found.notes])
    problems = [f"{problem.severity}: {problem.path}: {problem.message}" for problem in found.validation]
    yield from _section("validation", problems)


def _lens(readout: Readout) -> str:
    stop = f"f/{readout.f_stop:g}" if readout.f_stop > 0 else "pinhole"
    glass = f"{readout.lens_name or readout.lens_model}  " if readout.lens_name or readout.lens_model != "thin" else ""
    return (
        f"{glass}{readout.focal_length_mm:g} mm  {stop}  focus {_metres(readout.focus_distance_m)} ({readout.focus_mode}), "
        f"sharp from {_metres(readout.near_m)} to {_metres(readout.far_m)}"
    )


def _metres(distance_m: float) -> str:
    return f"{distance_m:.2f} m" if math.isfinite(distance_m) else "infinity"


def _section(title: str, lines: list[str]) -> Iterator[str]:
    yield title
    yield from (f"  {line}" for line in lines or ["nothing"])
