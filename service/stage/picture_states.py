"""Function of the stage process that digests what pictures depend on."""

from __future__ import annotations

from render.model.edit_history import revision_of
from render.shot.picture_state import picture_states
from service.models.frames import MAX_STATES, PictureState, PictureStates
from service.stage.opened import OpenedShot, stage_function
from service.stage.shots import curve_frames
from service.storage.store import ShotRecord


@stage_function
def read_picture_states(
    opened: OpenedShot, record: ShotRecord, edits: str, camera: str | None, frames: str | None
) -> PictureStates:
    """Digest what the pictures of frames depend on. Raises `CameraError` or `SettingsError`."""
    with opened.use(record, edits) as shot:
        times = curve_frames(shot, frames, MAX_STATES)
        states = picture_states(shot, camera, times)
    return PictureStates(
        revision=revision_of(edits),
        states=[PictureState(time=time, state=state) for time, state in zip(times, states, strict=True)],
    )
