"""Functions of the stage process that prepare renders: the edits that they keep, and what they would be."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from render.errors import PullfocusError
from render.film import GradeChoice
from render.shot import Shot
from render.shot.picture_height import picture_height
from service.models.cameras import CameraEdit
from service.models.changes import SetCamera
from service.models.frames import FrameQuery
from service.models.render_plans import PlanFinding, PlannedPicture, PlannedShot
from service.models.shots import FrameRange
from service.stage.camera_changes import EditedCamera
from service.stage.changes import apply_changes
from service.stage.opened import OpenedShot, as_sent, stage_function
from service.storage.store import ShotRecord
from usd_schemas.validation import validate

MOST_FINDINGS = 100
"""Findings of a plan; further ones are left out."""


@stage_function
def mount_lens(opened: OpenedShot, record: ShotRecord, edits: str, camera: str | None, lens: str) -> str:
    """Return the text of the edit layer with another lens on a camera; the edits of the shot stay as they are.

    Args:
        opened: the open shots.
        record: the shot.
        edits: text of its edit layer.
        camera: prim path, or None for the default camera.
        lens: name in the library.

    Raises:
        CameraError: there is no such camera.
        SettingsError: there is no such lens.
    """
    with opened.use(record, edits) as shot, _mounted(shot, camera, lens):
        return shot.edits.history.present.text


@stage_function
def plan_picture(
    opened: OpenedShot, record: ShotRecord, edits: str, query: FrameQuery, lens: str | None
) -> PlannedShot:
    """Tell what the first picture of a render would be, and what of the shot stands against it or is not honoured.

    Args:
        opened: the open shots.
        record: the shot.
        edits: text of its edit layer.
        query: the picture.
        lens: name of a lens of the library that is mounted for it; None keeps the camera's.
    """
    found: list[PlanFinding] = []
    with opened.use(record, edits) as shot:
        try:
            with _mounted(shot, query.camera, lens):
                picture = _picture(shot, query)
                found += _findings(shot)
        except PullfocusError as error:
            picture = None
            found = [
                PlanFinding(severity="error", code=error.code, path=error.path or "", message=error.detail),
                *found,
            ]
        frame_range = FrameRange.model_validate(shot.frame_range)
    sent = [
        one.model_copy(update={"path": as_sent(one.path, record), "message": as_sent(one.message, record)})
        for one in found
    ]
    return PlannedShot(picture=picture, frame_range=frame_range, findings=sent[:MOST_FINDINGS])


@contextmanager
def _mounted(shot: Shot, camera: str | None, lens: str | None) -> Iterator[None]:
    """Mount a lens for a while. Raises `CameraError`, `SettingsError`."""
    if lens is None:
        yield
        return
    before = shot.edits.snapshot()
    try:
        apply_changes(EditedCamera(shot, camera), [SetCamera(values=CameraEdit(lens=lens))])
        yield
    finally:
        shot.edits.restore(before)


def _picture(shot: Shot, query: FrameQuery) -> PlannedPicture:
    """Prepare the camera and the film of a picture, as it is drawn. Raises `CameraError`, `SettingsError`."""
    height = query.height or picture_height(shot, query.camera, query.time, query.width)
    camera = shot.camera_at(query.camera, query.time, query.width, height)
    choice = GradeChoice(display=query.display, view=query.view, look=query.look)
    finish = shot.film.finish(camera, query.time, None, query.film, None if choice == GradeChoice() else choice)
    shot.scene_at(query.time, camera.path)
    stock = None if finish.film is None else finish.film.stock
    return PlannedPicture(
        camera=query.camera or shot.default_camera().path,
        width=query.width,
        height=height,
        lens_name=camera.lens.name,
        lens_model=camera.lens.model,
        f_stop=camera.f_stop,
        focal_length_mm=camera.stated_focal_length_mm,
        film=None if stock is None else stock.name,
    )


def _findings(shot: Shot) -> Iterator[PlanFinding]:
    """Yield what of a shot is not honoured, and what its validators find."""
    notes = shot.findings()
    told = {note.message for note in notes}
    for note in notes:
        yield PlanFinding(severity="warning", code=note.code, path=note.path, message=note.message)
    for problem in validate(shot.stage):
        if problem.message not in told:
            yield PlanFinding(severity="warning", code=problem.rule, path=problem.path, message=problem.message)
