"""Functions of the stage process that compute and import focus curves."""

from __future__ import annotations

from typing import Literal

from render.errors import SettingsError
from render.focus.files import curve_to_text
from render.shot.focus.curve_import import read_for_shot
from service.edit_context import EditContext
from service.models.curve import CurveFileFormat, CurveFinding, ImportedCurve
from service.stage.opened import OpenedShots, stage_function
from service.stage.read_shot import camera_tag, curve_frames, read_camera_state
from service.storage.store import ShotRecord

_DRIVES: tuple[tuple[str, Literal["focusDistance", "fStop", "focalLength", "tilt", "swing"]], ...] = (
    ("focus_distance_m", "focusDistance"),
    ("f_stop", "fStop"),
    ("focal_length_mm", "focalLength"),
    ("tilt_rad", "tilt"),
    ("swing_rad", "swing"),
)


@stage_function
def compute_curve(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    frames: str | None,
    format: CurveFileFormat,
    baked: bool,
    max_frames: int,
) -> str:
    """Compute a focus curve as the text of a file. Raises `CameraError` or `SettingsError`."""
    with opened.use(record) as shot:
        times = curve_frames(shot, frames, max_frames)
        if format == "usda":
            return shot.focus.layer(camera, times, baked)
        return curve_to_text(shot.focus.curve(camera, times), format)


@stage_function
def import_curve(
    opened: OpenedShots,
    record: ShotRecord,
    camera: str | None,
    content: bytes,
    gaps: Literal["refuse", "hold", "interpolate"],
    first_frame: float | None,
    baked: bool,
    max_frames: int,
    context: EditContext,
) -> ImportedCurve:
    """Put a focus curve of another tool onto a camera.

    Raises:
        InputError: the file cannot be used.
        SettingsError: it has too many frames.
    """
    with opened.edit(record, context) as shot:
        context.check_tag(camera_tag(shot, camera), "the camera")
        read = read_for_shot(shot.stage, content, gaps=gaps, first_frame=first_frame)
        times = read.curve.time_codes
        if len(times) > max_frames:
            raise SettingsError(
                f"the file has {len(times):,} frames; at most {max_frames:,} are taken", code="bad_frames"
            )
        shot.focus.import_curve(camera, read, baked=baked)
        return ImportedCurve(
            camera=read_camera_state(shot, camera, float(times[0])),
            first_time=float(times[0]),
            last_time=float(times[-1]),
            frames=len(times),
            drives=[name for column, name in _DRIVES if column in read.said],
            findings=[CurveFinding.model_validate(finding) for finding in read.findings],
        )
