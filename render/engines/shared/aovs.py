"""AOVs: what is measured beside the colour of a picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from render.engines.shared.device import Device
from render.engines.shared.request import ALL_RAYS, DrawRequest
from render.model.arrays import FloatArray
from render.trace.aovs import MEASURED


def measure_aovs(
    device: Device, draw: Callable[[DrawRequest], FloatArray], request: DrawRequest
) -> dict[str, NDArray[Any]]:
    """Measure the AOVs that a picture's settings name.

    Args:
        device: with the scene loaded.
        draw: draws a picture by the engine, for the albedo.
        request: the picture.

    Returns:
        Arrays by name, as `render.frame.Frame.aovs` has them.
    """
    settings = request.settings
    values: dict[str, NDArray[Any]] = {}
    if set(settings.aovs) & set(MEASURED):
        values = device.tracer.measure_aovs(device.peeler, request.camera, request.view)
    if "albedo" in settings.aovs:
        unlit = replace(request, settings=replace(settings, shading="unlit"), part=ALL_RAYS, on_progress=None)
        values["albedo"] = draw(unlit)[..., :3]
    return {name: values[name] for name in settings.aovs if name != "color"}
