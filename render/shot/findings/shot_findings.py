"""Findings that reading and focusing a shot have brought up so far."""

from __future__ import annotations

from collections.abc import Iterable

from pxr import Usd

from render.model.scene import Light
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits
from render.shot.findings.camera_findings import (
    camera_findings,
    close_focus_findings,
    light_findings,
    lost_point_findings,
    unmet_findings,
    zoom_range_findings,
)
from render.shot.focus.focused_camera import FocusedCamera
from render.stage import Finding, StageReader, find_not_honoured
from render.stage.findings import condense

MAX_ALIKE = 50
"""Findings of one code that are listed one by one."""


class ShotFindings:
    """Collects what one shot asks for that is not honoured or cannot be used. It is a `FocusObserver`.

    Args:
        stage: the shot.
        edits: findings of the focus hold until the next edit.
        cameras: finds the stage's cameras.
        reader: has the findings of the scene.
    """

    def __init__(self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup, reader: StageReader) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras
        self._reader = reader
        self._lights: tuple[Light, ...] = ()
        self._asked: dict[Finding, None] = {}
        self._ignored: tuple[int, list[Finding]] | None = None  # after the revision of the edits
        self._focus: dict[Finding, int] = {}  # with the revision of the edits that each belongs to

    def all(self) -> list[Finding]:
        """Every finding so far that still holds; those of one code beyond `MAX_ALIKE` are one finding together."""
        cameras = camera_findings(self._stage, self._cameras.paths())
        focus = [finding for finding, revision in self._focus.items() if revision == self._edits.revision]
        found = [*self._reader.findings, *cameras, *light_findings(self._lights), *focus, *self._asked]
        return condense([*found, *self._not_honoured()], MAX_ALIKE)

    def note_asked(self, findings: Iterable[Finding]) -> None:
        """Note findings of what the stage's render settings ask for."""
        self._asked.update(dict.fromkeys(findings))

    def note_lights(self, lights: tuple[Light, ...]) -> None:
        """Keep the lights of the scene that was read last."""
        self._lights = lights

    def note_close_focus(self, focused: FocusedCamera) -> None:
        """Note a camera that is focused nearer than its lens is marked for, or zoomed beyond its range."""
        self._note(close_focus_findings(focused))
        self._note(zoom_range_findings(focused))

    def note_points(self, focused: FocusedCamera) -> None:
        """Note focus points that are lost, and a focus that the lens cannot meet."""
        self._note([*lost_point_findings(focused), *unmet_findings(focused)])

    def _not_honoured(self) -> list[Finding]:
        """Return what of the stage is not honoured; the whole stage is looked through for it once after each edit."""
        revision = self._edits.revision
        if self._ignored is None or self._ignored[0] != revision:
            self._ignored = revision, list(find_not_honoured(self._stage))
        return self._ignored[1]

    def _note(self, findings: Iterable[Finding]) -> None:
        self._focus.update(dict.fromkeys(findings, self._edits.revision))
