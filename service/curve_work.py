"""What the stage process is asked for about focus curves; see `service.stage_work`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from service.opened import OpenedShots
from service.store import ShotRecord


@dataclass(frozen=True)
class ComputeCurve:
    """The focus curve as a file."""

    record: ShotRecord
    camera: str | None
    frames: str | None
    format: Literal["json", "csv", "usda"]
    baked: bool
    max_frames: int

    def run(self, opened: OpenedShots) -> str:
        """Its text. Raises `CameraError` or `SettingsError`."""
        from render.focus import curve_to_csv, curve_to_json
        from service.reading import curve_frames

        with opened.use(self.record) as shot:
            times = curve_frames(shot, self.frames, self.max_frames)
            if self.format == "usda":
                return shot.focus_layer(self.camera, times, self.baked)
            curve = shot.focus_curve(self.camera, times)
            return curve_to_json(curve) if self.format == "json" else curve_to_csv(curve)
