"""Function of the stage process that digests what pictures depend on."""

from __future__ import annotations

from render.shot.picture_state import picture_states
from service.models.frames import PictureState, PictureStates
from service.stage.opened import OpenedShot, stage_function
from service.stage.shots import curve_frames
from service.storage.store import ShotRecord


@stage_function
def read_picture_states(
    opened: OpenedShot, record: ShotRecord, edits: str, camera: str | None, frames: str | None, max_frames: int
) -> PictureStates:
    """Digest what the pictures of frames depend on. Raises `CameraError` or `SettingsError`."""
    with opened.use(record, edits) as shot:
        times = curve_frames(shot, frames, max_frames)
        states = picture_states(shot, camera, times)
    return PictureStates(
        states=[PictureState(time=time, state=state) for time, state in zip(times, states, strict=True)]
    )
