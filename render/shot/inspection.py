"""Inspection of a shot: its contents, settings that are not honoured, and problems of its cameras."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from render.errors import PullfocusError, StageError
from render.model.scene import Batch
from render.shot.exposure.readout import ExposureReadout
from render.shot.findings.finish_findings import finish_findings
from render.shot.focus.readout import Readout
from render.shot.shot import Shot
from render.stage import (
    EYES,
    BackPlate,
    CameraChoice,
    Finding,
    FrameRange,
    StereoPair,
    is_y_up,
    list_plates,
    stereo_role,
)
from usd_schemas.units import metres_per_unit
from usd_schemas.validation import Problem, validate

_SQUARE_PX = (64, 64)
"""Size of a picture; no finish depends on it."""


@dataclass(frozen=True)
class Inspection:
    """Contents of a shot at its first frame.

    Attributes:
        frame_range: first and last frame, and the rate.
        up_axis: of the stage.
        metres_per_unit: length of a scene unit.
        cameras: prim paths.
        default_camera: the camera that is used when none is named, and why.
        readouts: the lens of each camera whose numbers are possible.
        exposures: of each camera whose exposure makes sense.
        back_plates: of all cameras.
        stereo_roles: of cameras that are an eye, by path.
        stereo_pairs: cameras of two eyes that belong together.
        prim_count: prims with geometry that are drawn.
        triangle_count: drawn, instances counted.
        splat_count: Gaussian splats, instances counted.
        light_count: lights, a dome among them.
        notes: settings that are not honoured or cannot be used.
        validation: problems from the schemas' validators.
    """

    frame_range: FrameRange
    up_axis: Literal["Y", "Z"]
    metres_per_unit: float
    cameras: tuple[str, ...]
    default_camera: CameraChoice
    readouts: tuple[Readout, ...]
    exposures: tuple[ExposureReadout, ...]
    back_plates: tuple[BackPlate, ...]
    stereo_roles: dict[str, str]
    stereo_pairs: tuple[StereoPair, ...]
    prim_count: int
    triangle_count: int
    splat_count: int
    light_count: int
    notes: tuple[Finding, ...]
    validation: tuple[Problem, ...]


def inspect_shot(shot: Shot) -> Inspection:
    """Inspect a shot at its first frame.

    Args:
        shot: the shot.

    Raises:
        StageError: the stage has numbers that no scene can have.
    """
    first = shot.frame_range.start
    default = _default_camera(shot)
    scene = shot.scene_at(first, default.path or "")
    surfaces = [batch for batch in scene.batches if not batch.material.unlit]  # without back plates
    readouts, exposures, unusable = _read_cameras(shot, first)
    problems = validate(shot.stage)
    shot.rendering_space()  # a finding where it is not that of rendering
    notes = (*shot.findings(), *unusable, *_finish_findings(shot, first, problems))
    messages = {note.message for note in notes}
    return Inspection(
        frame_range=shot.frame_range,
        up_axis="Y" if is_y_up(shot.stage) else "Z",
        metres_per_unit=metres_per_unit(shot.stage),
        cameras=tuple(shot.cameras()),
        default_camera=default,
        readouts=readouts,
        exposures=exposures,
        stereo_roles={path: role for path in shot.cameras() if (role := _role(shot, path)) in EYES},
        stereo_pairs=tuple(shot.stereo_pairs()),
        back_plates=tuple(list_plates(shot.stage, shot.cameras(), first)),
        prim_count=_count_prims(surfaces) + len({batch.prim_id for batch in scene.splats}),
        triangle_count=sum(len(batch.geometry.triangles) * len(batch.poses) for batch in surfaces),
        splat_count=sum(batch.count for batch in scene.splats),
        light_count=len(scene.lights) + (scene.dome is not None),
        notes=notes,
        validation=tuple(problem for problem in problems if problem.message not in messages),
    )


def _default_camera(shot: Shot) -> CameraChoice:
    """The shot's default camera; an empty choice where there is none, nor anything to frame."""
    try:
        return shot.default_camera()
    except StageError as error:
        return CameraChoice(None, error.detail)


def _role(shot: Shot, camera_path: str) -> str:
    return stereo_role(shot.stage.GetPrimAtPath(camera_path))


def _read_cameras(
    shot: Shot, time: float
) -> tuple[tuple[Readout, ...], tuple[ExposureReadout, ...], tuple[Finding, ...]]:
    """Read lens and exposure of each camera; a camera that cannot be used is a finding."""
    readouts, exposures, unusable = [], [], []
    for path in shot.cameras():
        try:
            readouts.append(shot.focus.read(path, time))
            exposures.append(shot.exposure.read(path, time))
        except PullfocusError as error:
            unusable.append(Finding(error.code, path, error.detail))
    return tuple(readouts), tuple(exposures), tuple(unusable)


def _finish_findings(shot: Shot, time: float, problems: Sequence[Problem]) -> Iterator[Finding]:
    return finish_findings(
        shot.stage, lambda path, at: shot.camera_at(path, at, *_SQUARE_PX), shot.cameras(), time, problems
    )


def _count_prims(surfaces: Sequence[Batch]) -> int:
    drawn: set[int] = set()
    for batch in surfaces:
        ids = batch.geometry.prim_ids if batch.instance_prim_ids is None else batch.instance_prim_ids
        drawn.update(np.unique(ids).tolist())
    return len(drawn)
