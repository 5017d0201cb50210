"""Functions of the stage process that concern a shot as a whole.

The stage process is the only one that edits shots: calls run one after the other, and each edit is on disk before its reply is
sent. Every function takes the worker's `OpenedShot` first and replies with a model; `service.stage.calls` names these modules
for the HTTP process.
"""

from __future__ import annotations

import math
from pathlib import Path

from pxr import UsdUtils

from render.demo.shot import write_demo as write_demo_files
from render.errors import SettingsError, StageError
from render.model.edit_history import revision_of
from render.model.frame_spec import parse_frames
from render.shot import Shot as OpenShot
from render.shot.inspection import inspect_shot as inspect_open_shot
from service.models.inspection import Inspection, Note, ValidationFinding
from service.models.shots import FrameRange, Shot, ShotSummary
from service.stage.opened import OpenedShot, as_sent, stage_function
from service.stage.read_cameras import default_camera_model, readout_model
from service.storage.store import ShotRecord


@stage_function
def describe_shot(opened: OpenedShot, record: ShotRecord) -> Shot:
    """Open a shot and read its frame range and cameras. Raises the errors of `render.shot.Shot.open`."""
    with opened.use(record) as shot:
        return shot_model(record, shot)


@stage_function
def inspect_shot(opened: OpenedShot, record: ShotRecord, edits: str) -> Inspection:
    """Read a shot at its first frame and list its contents and what of it is not honoured. Raises `StageError`."""
    with opened.use(record, edits) as shot:
        return inspection_model(record, shot)


@stage_function
def write_demo(opened: OpenedShot, folder: Path) -> str:
    """Author the demo shot and return its root layer, relative to the folder. Raises `OutputError`."""
    silenced = UsdUtils.CoalescingDiagnosticDelegate()  # USD warns that a sandbox lets it set no permissions
    try:
        return write_demo_files(folder).relative_to(folder).as_posix()
    finally:
        silenced.TakeUncoalescedDiagnostics()


def shot_model(record: ShotRecord, shot: OpenShot) -> Shot:
    """Read a shot with its frame range and cameras. Raises `StageError`: its frame range is not finite."""
    return Shot(
        **ShotSummary.model_validate(record).model_dump(),
        revision=revision_of(record.edit_text()),
        frame_range=_frame_range(shot),
        cameras=shot.cameras(),
        default_camera=default_camera_model(shot),
    )


def inspection_model(record: ShotRecord, shot: OpenShot) -> Inspection:
    """Inspect a shot at its first frame: its contents, unsupported features, and findings of the validators."""
    frame_range = _frame_range(shot)
    inspection = inspect_open_shot(shot)
    return Inspection(
        frame_range=frame_range,
        up_axis=inspection.up_axis,
        meters_per_unit=inspection.metres_per_unit,
        cameras=list(inspection.cameras),
        default_camera=default_camera_model(shot),
        readouts=[readout_model(readout, frame_range.start) for readout in inspection.readouts],
        prim_count=inspection.prim_count,
        triangle_count=inspection.triangle_count,
        light_count=inspection.light_count,
        notes=[
            Note(
                code=note.code,
                path=as_sent(note.path, record),
                message=as_sent(note.message, record),
                count=note.count,
            )
            for note in inspection.notes
        ],
        validation=[ValidationFinding.model_validate(problem) for problem in inspection.validation],
    )


def curve_frames(shot: OpenShot, spec: str | None, max_frames: int) -> list[float]:
    """Return the frames of a focus curve or the like: those of a specification, or the whole shot.

    Args:
        shot: the shot.
        spec: such as ``1:96``; None for the whole shot.
        max_frames: limit of their number.

    Raises:
        SettingsError: the specification cannot be read, or there are too many frames.
    """
    if spec is not None:
        frames = parse_frames(spec)
        count = len(frames)
    else:
        whole = _frame_range(shot)
        count = max(1, math.floor(whole.end - whole.start) + 1)
    if count > max_frames:
        raise SettingsError(f"{count:,} frames were requested; at most {max_frames:,} are returned at once")
    return frames if spec is not None else [whole.start + n for n in range(count)]


def _frame_range(shot: OpenShot) -> FrameRange:
    frame_range = shot.frame_range
    if not all(map(math.isfinite, (frame_range.start, frame_range.end, frame_range.frames_per_second))):
        raise StageError(f"the frame range of the stage is not finite: {frame_range}", code="bad_frame_range")
    return FrameRange.model_validate(frame_range)
