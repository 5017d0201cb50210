"""Function of the picture process that meters the light of a shot."""

from __future__ import annotations

from typing import Any

from render.shot.light_meter import LightMeter
from service.models.metering import MeterMode, MeterReading
from service.picture.state import PictureWorkerState, picture_function
from service.storage.store import ShotRecord

UNSMOOTHED_S = 0.04
"""Smoothing time of a meter that the camera does not follow: the reading is of this frame alone."""


@picture_function
def meter_light(
    state: PictureWorkerState,
    record: ShotRecord,
    edits: str,
    camera: str | None,
    time: float,
    mode: MeterMode | None,
    spot: str | tuple[float, float] | None,
) -> MeterReading:
    """Meter the light of a shot.

    Args:
        state: the worker's state.
        record: the shot.
        edits: text of its edit layer at the time of the request.
        camera: prim path, or None for the default camera.
        time: USD time code.
        mode: metering mode; None takes the camera's, or centre-weighted where it has no meter.
        spot: name of a focus point, or a position in the picture; None takes the camera's.

    Raises:
        CameraError: it is no camera.
        SettingsError: the camera has no such focus point, or makes no picture.
    """
    with state.opened.use(record, edits) as shot:
        decides = LightMeter(state.renderer, shot, camera).metering(time).mode != "manual"
        settings: dict[str, Any] = {} if decides else {"mode": "center", "smoothing_s": UNSMOOTHED_S}
        if mode is not None:
            settings["mode"] = mode
        if isinstance(spot, str):
            settings |= {"mode": "spot", "focus_point": spot}
        elif spot is not None:
            settings |= {"mode": "spot", "focus_point": "", "spot": spot}
        metered = LightMeter(state.renderer, shot, camera, **settings).read(time)
    return MeterReading.model_validate(
        {
            "camera": metered.exposure.camera,
            "time": time,
            "mode": metered.mode,
            "place": metered.place,
            "luminance_nits": metered.reading.luminance_nits,
            "ev100": metered.reading.ev100,
            "incident_lux": metered.reading.incident_lux,
            "film_lux": metered.lux_on_film,
            "stops": metered.reading.stops,
            "compensation_stops": metered.compensation_stops,
            "decides": decides,
        }
    )
