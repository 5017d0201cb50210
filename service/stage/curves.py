"""What the stage process is asked about focus curves; see `service.stage.shots`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from render.errors import SettingsError
from service.models.curve import CurveFinding, ImportedCurve
from service.stage.opened import OpenedShots
from service.storage.store import ShotRecord
from service.terms import Terms

CurveFileFormat = Literal["json", "csv", "usda", "otio", "opentrackio"]

_DRIVES: tuple[tuple[str, Literal["focusDistance", "fStop", "focalLength", "tilt", "swing"]], ...] = (
    ("focus_distance_m", "focusDistance"),
    ("f_stop", "fStop"),
    ("focal_length_mm", "focalLength"),
    ("tilt_rad", "tilt"),
    ("swing_rad", "swing"),
)


@dataclass(frozen=True)
class ComputeCurve:
    """The focus curve as a file."""

    record: ShotRecord
    camera: str | None
    frames: str | None
    format: CurveFileFormat
    baked: bool
    max_frames: int

    def run(self, opened: OpenedShots) -> str:
        """Its text. Raises `CameraError` or `SettingsError`."""
        from render.focus.files import curve_to_text
        from service.stage.read_shot import curve_frames

        with opened.use(self.record) as shot:
            times = curve_frames(shot, self.frames, self.max_frames)
            if self.format == "usda":
                return shot.focus_layer(self.camera, times, self.baked)
            return curve_to_text(shot.focus_curve(self.camera, times), self.format)


@dataclass(frozen=True)
class ImportCurve:
    """A focus curve that another tool made, put onto a camera."""

    record: ShotRecord
    camera: str | None
    content: bytes
    gaps: Literal["refuse", "hold", "interpolate"]
    first_frame: float | None
    baked: bool
    max_frames: int
    terms: Terms

    def run(self, opened: OpenedShots) -> ImportedCurve:
        """What came of it. Raises `InputError`: the file cannot be used; `SettingsError`: it has too many frames."""
        from render.shot.edits.curve_import import read_for_shot
        from service.stage.read_shot import camera_tag, read_camera_state

        with opened.edit(self.record, self.terms) as shot:
            self.terms.check(camera_tag(shot, self.camera), "the camera")
            read = read_for_shot(shot.stage, self.content, gaps=self.gaps, first_frame=self.first_frame)
            times = read.curve.time_codes
            if len(times) > self.max_frames:
                raise SettingsError(
                    f"the file has {len(times):,} frames; at most {self.max_frames:,} are taken", code="bad_frames"
                )
            shot.import_focus_curve(self.camera, read, baked=self.baked)
            return ImportedCurve(
                camera=read_camera_state(shot, self.camera, float(times[0])),
                first_time=float(times[0]),
                last_time=float(times[-1]),
                frames=len(times),
                drives=[name for column, name in _DRIVES if column in read.said],
                findings=[CurveFinding.model_validate(finding) for finding in read.findings],
            )
