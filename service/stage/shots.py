"""Functions of the stage process that concern a shot as a whole.

The stage process is the only one that edits shots: calls run one after the other, and each edit is on disk before its reply is
sent. Every function takes the worker's `OpenedShots` first and replies with a model; `service.stage.calls` names these modules
for the HTTP process.
"""

from __future__ import annotations

from pathlib import Path

from render.demo.shot import write_demo as write_demo_files
from service.models.inspection import Inspection
from service.models.shots import Shot
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import describe, inspect
from service.storage.store import ShotRecord


@stage_function
def describe_shot(opened: OpenedShots, record: ShotRecord) -> Shot:
    """Open a shot and read its frame range and cameras. Raises the errors of `render.shot.Shot.open`."""
    with opened.use(record) as shot:
        return describe(record, shot)


@stage_function
def inspect_shot(opened: OpenedShots, record: ShotRecord) -> Inspection:
    """Read a shot at its first frame and list its contents and what of it is not honoured. Raises `StageError`."""
    with opened.use(record) as shot:
        return inspect(record, shot)


@stage_function
def close_shot(opened: OpenedShots, shot_id: str) -> None:
    """Close a shot that was removed or refused."""
    opened.close(shot_id)


@stage_function
def write_demo(opened: OpenedShots, folder: Path) -> str:
    """Author the demo shot and return its root layer, relative to the folder. Raises `OutputError`."""
    return write_demo_files(folder).relative_to(folder).as_posix()
