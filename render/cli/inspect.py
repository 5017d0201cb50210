"""`pullfocus inspect`: contents of a shot, settings that are not honoured, and problems."""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import asdict, astuple
from typing import Any

from render.cli.console import camel_case_keys, finite, print_json
from render.cli.options import shared
from render.cli.tables.exposure import exposure_json, exposure_line
from render.errors import one_line
from render.optics.photometry.exposure import ExposureSettings
from render.shot import Readout
from render.shot.inspection import Inspection, inspect_shot

_HEADER = {"format": "pullfocus.inspection", "version": 1}
"""First keys of the JSON document. A key that goes or changes its meaning raises the version; a new key does not."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.set_defaults(run=run)
    shared.add_stage(parser)
    parser.add_argument("--json", action="store_true", help="print JSON (in the reference: Inspection)")


def run(arguments: argparse.Namespace) -> None:
    """Print the contents of a shot at its first frame.

    Args:
        arguments: as `add_arguments` declares them.

    Raises:
        StageError: it cannot be read.
    """
    inspection = inspect_shot(shared.open_shot(arguments))
    if arguments.json:
        print_json({**_HEADER, "stage": arguments.stage, **inspection_json(inspection)})
    else:
        print("\n".join(map(one_line, _lines(arguments.stage, inspection))))


def inspection_json(inspection: Inspection) -> dict[str, Any]:
    """Convert an inspection to JSON with the keys of the REST service; infinite distances are null.

    Args:
        inspection: of a shot.
    """
    return {
        "frameRange": camel_case_keys(asdict(inspection.frame_range)),
        "upAxis": inspection.up_axis,
        "metersPerUnit": inspection.metres_per_unit,
        "cameras": list(inspection.cameras),
        "defaultCamera": {"path": inspection.default_camera.path, "reason": inspection.default_camera.reason},
        "readouts": [finite(camel_case_keys(asdict(readout))) for readout in inspection.readouts],
        "exposures": [{"camera": read.camera, **exposure_json(read)} for read in inspection.exposures],
        "backPlates": [camel_case_keys(asdict(plate)) for plate in inspection.back_plates],
        "stereoRoles": [{"camera": path, "role": role} for path, role in inspection.stereo_roles.items()],
        "stereoPairs": [asdict(pair) for pair in inspection.stereo_pairs],
        "primCount": inspection.prim_count,
        "triangleCount": inspection.triangle_count,
        "splatCount": inspection.splat_count,
        "lightCount": inspection.light_count,
        "notes": [asdict(note) for note in inspection.notes],
        "validation": [asdict(problem) for problem in inspection.validation],
    }


def _lines(stage: str, inspection: Inspection) -> Iterator[str]:
    frames = inspection.frame_range
    yield stage
    yield f"  frames    {frames.start:g} to {frames.end:g}, {frames.frames_per_second:g} a second"
    yield f"  units     {inspection.metres_per_unit:g} m, {inspection.up_axis} up"
    splats = f", {inspection.splat_count:,} splats" if inspection.splat_count else ""
    yield (
        f"  drawn     {inspection.prim_count:,} prims, {inspection.triangle_count:,} triangles{splats}, "
        f"{inspection.light_count:,} lights at frame {frames.start:g}"
    )
    yield "cameras"
    default = inspection.default_camera
    exposed = {read.camera: exposure_line(read) for read in inspection.exposures if read.settings != ExposureSettings()}
    described = {readout.camera: _lens(readout) for readout in inspection.readouts}
    for path in inspection.cameras:
        yield f"  {path}  {described.get(path, 'cannot be used')}{' (default)' if path == default.path else ''}"
        if path in exposed:
            yield f"    exposed {exposed[path]}"
        if path in inspection.stereo_roles:
            yield f"    {_eye(path, inspection)}"
        for plate in inspection.back_plates:
            if plate.camera == path:
                place = "nowhere" if plate.depth_m is None else f"at {_metres(plate.depth_m)}"
                yield f"    back plate {plate.name}  {plate.image or 'no image'}  {place} ({plate.visibility})"
    yield f"  without --camera: {default.path or 'one that frames the stage'} ({default.reason})"
    yield from _section("not honoured", [note.message for note in inspection.notes])
    problems = [f"{problem.severity}: {problem.path}: {problem.message}" for problem in inspection.validation]
    yield from _section("validation", problems)


def _eye(path: str, inspection: Inspection) -> str:
    others = [
        pair.right if path == pair.left else pair.left for pair in inspection.stereo_pairs if path in astuple(pair)
    ]
    role = inspection.stereo_roles[path]
    return f"{role} eye, with {others[0]}" if others else f"{role} eye, of no pair"


def _lens(readout: Readout) -> str:
    stop = f"f/{readout.f_stop:g}" if readout.f_stop > 0 else "pinhole"
    glass = f"{readout.lens_name or readout.lens_model}  " if readout.lens_name or readout.lens_model != "thin" else ""
    field = "orthographic" if readout.orthographic else f"{readout.focal_length_mm:g} mm"
    return (
        f"{glass}{field}  {stop}  focus {_metres(readout.focus_distance_m)} ({readout.focus_mode}), "
        f"sharp from {_metres(readout.near_m)} to {_metres(readout.far_m)}"
    )


def _metres(distance_m: float) -> str:
    return f"{distance_m:.2f} m" if math.isfinite(distance_m) else "infinity"


def _section(title: str, lines: list[str]) -> Iterator[str]:
    yield title
    yield from (f"  {line}" for line in lines or ["nothing"])
