"""Functions of the stage process that compute and import focus curves."""

from __future__ import annotations

from collections.abc import Sequence

from render.focus.files import curve_to_text
from render.shot import Shot
from service.edit_context import EditContext
from service.models.changes import ImportCurve
from service.models.curve import CurveFileFormat, ImportedCurve
from service.stage.editing import apply_in_context
from service.stage.opened import OpenedShot, stage_function
from service.stage.shots import curve_frames
from service.storage.store import ShotRecord


@stage_function
def compute_curve(
    opened: OpenedShot,
    record: ShotRecord,
    edits: str,
    camera: str | None,
    frames: str | None,
    format: CurveFileFormat,
    baked: bool,
    max_frames: int,
) -> str:
    """Compute a focus curve as the text of a file. Raises `CameraError` or `SettingsError`."""
    with opened.use(record, edits) as shot:
        times = curve_frames(shot, frames, max_frames)
        return _curve_text(shot, camera, times, format, baked=baked)


@stage_function
def compute_curve_at(
    opened: OpenedShot,
    record: ShotRecord,
    edits: str,
    camera: str | None,
    times: Sequence[float],
    format: CurveFileFormat,
) -> str:
    """Compute a focus curve at given USD time codes as the text of a file. Raises `CameraError` or `SettingsError`."""
    with opened.use(record, edits) as shot:
        return _curve_text(shot, camera, list(times), format)


@stage_function
def import_curve(
    opened: OpenedShot,
    record: ShotRecord,
    camera: str | None,
    change: ImportCurve,
    max_frames: int,
    context: EditContext,
) -> ImportedCurve:
    """Put a focus curve of another tool onto a camera.

    Raises:
        InputError: the file cannot be used.
        SettingsError: it has too many frames.
    """
    with opened.edit(record, context) as shot:
        (imported,) = apply_in_context(shot, camera, [change], context, max_frames)
        assert isinstance(imported, ImportedCurve)
        return imported


def _curve_text(
    shot: Shot, camera: str | None, times: list[float], format: CurveFileFormat, *, baked: bool = False
) -> str:
    if format == "usda":
        return shot.focus.layer(camera, times, baked)
    return curve_to_text(shot.focus.curve(camera, times, distortion=format == "opentrackio"), format)
