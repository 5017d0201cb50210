"""What the stage process is asked for: everything about a shot that needs USD and no GL. This file has what is of a whole shot.

It is the one place where shots are edited: requests run one after the other, and each edit is on disk before it is
answered. Each request is a small value that is sent there, and its ``run`` answers with a model. The process that speaks
HTTP imports these modules (``service.*_work``) to make them, so what needs USD is imported where it runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from service.models.inspection import Inspection
from service.models.shots import Shot
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord


@dataclass(frozen=True)
class DescribeShot:
    """Open a shot and say what does not change while it is looked at."""

    record: ShotRecord

    def run(self, opened: OpenedShots) -> Shot:
        """Raises what `render.shot.Shot.open` raises."""
        from service.stage.read_shot import describe

        with opened.use(self.record) as shot:
            return describe(self.record, shot)


@dataclass(frozen=True)
class InspectShot:
    """Read a shot at its first frame and say what is in it and what of it is not honoured."""

    record: ShotRecord

    def run(self, opened: OpenedShots) -> Inspection:
        """Raises `StageError`: it cannot be read."""
        from service.stage.read_shot import inspect

        with opened.use(self.record) as shot:
            return inspect(self.record, shot)


@dataclass(frozen=True)
class ForgetShot:
    """Close a shot that was removed or refused."""

    shot_id: str

    def run(self, opened: OpenedShots) -> None:
        """Close it."""
        opened.forget(self.shot_id)


@dataclass(frozen=True)
class WriteDemo:
    """Author the demo shot."""

    folder: Path

    def run(self, opened: OpenedShots) -> str:
        """Its root layer, relative to the folder. Raises `OutputError`."""
        from render.demo.shot import write_demo

        return write_demo(self.folder).relative_to(self.folder).as_posix()
