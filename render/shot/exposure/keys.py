"""Metered exposure as keys of the attribute ``exposure``: as a layer over the shot, or in the stage's edit target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Literal, Protocol

import numpy as np
from pxr import Sdf, Usd

from render.errors import InputError
from render.model.arrays import DoubleArray
from render.optics.photometry.metering import one_key
from render.shot.edits.edit_layer import schema_errors_as_settings, set_value
from render.stage import quiet_diagnostics
from usd_schemas import LensCamera, curves

EXPOSURE = "exposure"
TOLERANCE_STOPS = 0.005
"""Largest error of splines at the frames, below what the eye can see."""


class MeteredStops(Protocol):
    """Reading of a light meter at a time."""

    @property
    def time(self) -> float:
        """USD time code."""

    @property
    def compensation_stops(self) -> float:
        """In place of the camera's; not finite for a black frame."""


def compensation_stops(readings: Sequence[MeteredStops], *, held: bool = False) -> DoubleArray:
    """Return the compensation of each frame, interpolated over black frames.

    Args:
        readings: of the meter, in order of time.
        held: one compensation for all frames.

    Returns:
        ``(n,)`` stops.

    Raises:
        InputError: every frame is black.
    """
    stops = np.array([reading.compensation_stops for reading in readings])
    lit = np.isfinite(stops)
    if not lit.any():
        raise InputError(
            "there is nothing to meter: every frame is black where the meter looks", code="nothing_to_meter"
        )
    if held:
        return np.full(len(readings), one_key(stops))
    times = np.array([reading.time for reading in readings])
    return np.asarray(np.interp(times, times[lit], stops[lit]))


def exposure_layer(
    stage: Usd.Stage, camera_path: str, times: Sequence[float], stops: DoubleArray, *, baked: bool
) -> str:
    """Write a layer that exposes a camera as metered, to be sublayered over the shot by any tool.

    It sets ``film:metering:mode`` to manual where the shot uses a meter, so that a tool which has one does not meter again.

    Args:
        stage: the shot; it is not changed.
        camera_path: of a camera.
        times: rising USD time codes.
        stops: ``(n,)`` compensation at each.
        baked: time samples, for tools that read no splines, in place of native splines.

    Returns:
        usda text.

    Raises:
        SettingsError: it is no camera, or the times do not rise.
    """
    with schema_errors_as_settings(), quiet_diagnostics():
        form: Literal["spline", "samples"] = "samples" if baked else "spline"
        layer = curves.camera_layer(
            stage, camera_path, times, {EXPOSURE: stops}, form, {EXPOSURE: np.float64(TOLERANCE_STOPS)}
        )
        spec = layer.GetPrimAtPath(camera_path)
        if _is_constant(stops):
            for key in ("spline", "timeSamples"):
                spec.attributes[EXPOSURE].ClearInfo(key)
            spec.attributes[EXPOSURE].default = float(stops[0])
        layer.comment = f"Exposure of {camera_path}, metered by Pullfocus: sublayer this over the shot."
        if LensCamera(stage.GetPrimAtPath(camera_path)).film.read().metering.mode != "manual":
            mode = Sdf.AttributeSpec(spec, "film:metering:mode", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
            mode.default = "manual"
        return str(layer.ExportToString())


def author_exposure(camera: LensCamera, times: Sequence[float], stops: DoubleArray, *, baked: bool = False) -> None:
    """Author the metered exposure of a camera in the stage's edit target, and set its metering mode to manual.

    Args:
        camera: the camera.
        times: rising USD time codes.
        stops: ``(n,)`` compensation at each.
        baked: time samples in place of native splines.

    Raises:
        SchemaError: the times do not rise.
    """
    stage, path = camera.prim.GetStage(), str(camera.prim.GetPath())
    if _is_constant(stops):
        set_value(camera.prim.GetAttribute(EXPOSURE), float(stops[0]), None)
    elif baked:
        curves.author_samples(stage, path, times, {EXPOSURE: stops})
    else:
        curves.author_splines(stage, path, times, {EXPOSURE: stops}, {EXPOSURE: TOLERANCE_STOPS})
    film = camera.film.read()
    if film.metering.mode != "manual":
        camera.film.author(replace(film, metering=replace(film.metering, mode="manual")))


def _is_constant(stops: DoubleArray) -> bool:
    return bool((stops == stops[0]).all())
