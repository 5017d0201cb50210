"""Exposure of a camera: stop, shutter, sensitivity, filters and meter, and their keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field

from service.models.base import KEYS_AT, Model, TimeCode, shown_as
from service.models.focus import KEY_EXAMPLE, Key
from service.models.settings import example_of, keyed_names, with_edits, with_settings

EXPOSURE_EXAMPLE = example_of(
    "exposure",
    {
        "camera": "/World/main_cam",
        "time": 24.0,
        "exposureTimeS": 0.02083,
        "iso": 800.0,
        "exposureFStop": 2.0,
        "exposureStop": "iris",
        "stopMarking": "t",
        "transmittance": 0.9,
        "neutralDensity": 0.6,
        "flareStar": 1.0,
        "shutterClose": 0.5,
        "shutterAngleDeg": 180.0,
        "keys": {"compensationStops": [KEY_EXAMPLE]},
        "etag": '"92c4bf18a0860070"',
    },
)

if TYPE_CHECKING:
    ExposureKeyed = str
else:
    ExposureKeyed = Literal[keyed_names("exposure")]


@with_settings("exposure")
class ExposureSettings(Model):
    """Exposure settings of a camera at one time."""

    model_config = shown_as(EXPOSURE_EXAMPLE)

    camera: str = Field(description="Prim path.")
    time: float = Field(description="USD time code.")
    keys: dict[ExposureKeyed, list[Key]] = Field(description="Keys in order of time, of each setting that has any.")
    etag: str = Field(description="The camera's `ETag`: for `If-Match`.")


@with_edits("exposure")
class ExposureSettingsEdit(Model):
    """Exposure settings to change; a setting left out stays as it is."""

    model_config = shown_as({"iso": 800, "shutterAngleDeg": 172.8, "exposureTimeS": 0.02, "exposureStop": "iris"})

    time: TimeCode | None = Field(default=None, description=KEYS_AT)
