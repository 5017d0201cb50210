"""AOVs: what is measured beside the colour of a picture."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from render.engines.shared.device import Device
from render.engines.shared.request import ALL_RAYS, DrawRequest
from render.model.arrays import DoubleArray, FloatArray
from render.trace.aovs import Measurements, is_measured


def measure_aovs(
    device: Device, draw: Callable[[DrawRequest], FloatArray], request: DrawRequest, stage_from_world: DoubleArray
) -> Measurements:
    """Measure the AOVs that a picture's settings name.

    Args:
        device: with the scene loaded.
        draw: draws a picture by the engine, for the albedo.
        request: the picture.
        stage_from_world: `Scene.stage_from_world`.

    Returns:
        Arrays by name, as `render.frame.Frame.aovs` has them, but for primvars and mattes.
    """
    settings = request.settings
    measured = Measurements()
    if any(map(is_measured, settings.aovs)):
        measured = device.tracer.measure_aovs(
            device.peeler, request.camera, request.view, stage_from_world, settings.aovs
        )
    if "albedo" in settings.aovs:
        unlit = replace(
            request, settings=replace(settings, shading="unlit"), part=ALL_RAYS, on_progress=None, mattes=None
        )
        measured.values["albedo"] = draw(unlit)[..., :3]
    return measured
