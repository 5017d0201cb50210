"""The exposure part of a shot: settings and readouts of the exposure, and its keys from a light meter."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import Any

from pxr import Usd

from render.errors import SettingsError
from render.shot.camera.attributes import author_settings, read_settings, setting_label
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits
from render.shot.exposure.keys import MeteredStops, author_exposure, compensation_stops
from render.shot.exposure.metering import read_metering
from render.shot.exposure.readout import ExposureReadout, read_exposure
from render.shot.focus.solver import FocusSolver
from render.stage import StageReader
from usd_schemas import Metering
from usd_schemas.settings.tables import EXPOSURE_SETTINGS


class ShotExposure:
    """Exposure of the cameras of one shot.

    Args:
        stage: the shot.
        edits: where edits go.
        cameras: finds cameras by path.
        solver: solves the focus, on which the bellows factor depends.
        reader: tells when the scene has changed.
    """

    def __init__(
        self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup, solver: FocusSolver, reader: StageReader
    ) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras
        self._solver = solver
        self._reader = reader
        self._meter_cache: tuple[int, dict[Hashable, float]] = 0, {}

    def read(self, camera_path: str | None, time: float) -> ExposureReadout:
        """Read how a camera exposes: its settings, and all that stands between the scene and the film.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_exposure(self._stage, self._solver.solve(camera_path, time).camera, time)

    def settings(self, camera_path: str | None, time: float) -> Mapping[str, Any]:
        """Exposure, shutter, stray light and metering of a camera, by the names of `EXPOSURE_SETTINGS`.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_settings(self._cameras.camera(camera_path), EXPOSURE_SETTINGS, time)

    def set(self, camera_path: str | None, *, time: float | None = None, **settings: Any) -> None:
        """Change how a camera exposes.

        Args:
            camera_path: of a camera.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time. Words hold for
                all time either way.
            settings: by the names of `EXPOSURE_SETTINGS`.

        Raises:
            SettingsError: there is no such setting, a value is out of range, or the time is not finite.
        """
        camera = self._cameras.editable(camera_path)
        unknown = set(settings) - set(EXPOSURE_SETTINGS)
        if unknown:
            raise SettingsError(f"the exposure has no {', '.join(sorted(unknown))} to set", code="bad_field")
        labels = ", ".join(map(setting_label, settings))
        with self._edits.transaction(f"set {labels} of {camera.prim.GetName()}"):
            author_settings(camera, settings, time)

    def metering(self, camera_path: str | None, time: float) -> Metering:
        """Metering settings of a camera.

        Args:
            camera_path: of a camera.
            time: USD time code.

        Raises:
            CameraError: it is no camera, or a setting has no meaning.
        """
        return read_metering(self._stage, self._cameras.path(camera_path), time)

    def key(self, camera_path: str | None, readings: Sequence[MeteredStops], *, held: bool = False) -> None:
        """Expose a camera by hand from now on, with keys from a light meter.

        Args:
            camera_path: of a camera.
            readings: of the meter, in order of time.
            held: one exposure for all of them, in place of a native spline.

        Raises:
            InputError: every frame is black.
        """
        camera, stops = self._cameras.editable(camera_path), compensation_stops(readings, held=held)
        with self._edits.transaction(f"key the metered exposure of {camera.prim.GetName()}"):
            author_exposure(camera, [reading.time for reading in readings], stops)

    @property
    def meter_cache(self) -> dict[Hashable, float]:
        """Luminances that light meters (`render.shot.light_meter`) have read from the scene as it is, for them to look up and
        fill. It is emptied when the scene changes.
        """
        if self._meter_cache[0] != self._reader.changes:
            self._meter_cache = self._reader.changes, {}
        return self._meter_cache[1]
