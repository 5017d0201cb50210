"""Places of back plates (UsdGeomBackPlateAPI): where a camera's plates stand, and how large they are.

A plate stands at the camera's ``focusDistance``, its centre on the axis, as large as the film gate sees there; its ``tweak``
properties scale it about its centre, then turn it, then move it. That is what Hydra's back plate scene index draws. A scaled
camera does not scale its plates here, as it does not scale its focus distance: a plate without tweaks is in focus.
"""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray
from render.stage.values import UNREADABLE, format_value

CORNERS = np.array([(0.5, 0.5, 0.0), (-0.5, 0.5, 0.0), (-0.5, -0.5, 0.0), (0.5, -0.5, 0.0)])
"""Corners of a plate in its own space, counter-clockwise as its camera sees them."""
_TENTH = 0.1  # apertures and focal lengths are in tenths of scene units
_AXES = ((1, 2), (2, 0), (0, 1))
_LEAST_AREA = 1e-30  # square scene units


class PlateError(ValueError):
    """Plate that cannot be placed; the message gives the property, what it must be and what it is."""


def plate_names(prim: Usd.Prim) -> list[str]:
    """Names of the back plates that are applied to a camera."""
    applied = map(Usd.SchemaRegistry.GetTypeNameAndInstance, prim.GetAppliedSchemas())
    return [str(instance) for name, instance in applied if name == "BackPlateAPI"]


def read_plate_place(camera: UsdGeom.Camera, name: str, time: Usd.TimeCode) -> DoubleArray:
    """Matrix ``(4, 4)`` to camera space, in scene units, from a plate's own space, in which it is a square of side 1.

    Args:
        camera: the camera.
        name: of the plate.
        time: USD time code.

    Raises:
        PlateError: a property is not usable.
    """
    plate = UsdGeom.BackPlateAPI(camera.GetPrim(), name)
    turns = read_numbers(plate.GetRotateXYZTweakAttr(), time, 3)
    distance, size = _read_size(camera, time)
    matrix = np.eye(4)
    matrix[:3, :3] = _turn(0, turns[0]) @ _turn(1, turns[1]) @ _turn(2, turns[2])
    scale = read_numbers(plate.GetScaleTweakAttr(), time, 2)
    if abs(np.prod(size * scale)) < _LEAST_AREA:
        x, y = scale
        raise PlateError(f"{plate.GetScaleTweakAttr().GetName()} must not be 0 either way, got ({x:g}, {y:g})")
    matrix[:3, :3] @= np.diag([*(size * scale), 1.0])
    matrix[:3, 3] = read_numbers(plate.GetTranslateTweakAttr(), time, 3) - [0, 0, distance]
    return matrix


def read_numbers(attribute: Usd.Attribute, time: Usd.TimeCode, count: int) -> DoubleArray:
    """The ``(count,)`` numbers of an attribute.

    Raises:
        PlateError: they are not so many, or not finite.
    """
    value = attribute.Get(time)
    try:
        numbers = np.asarray(value, np.float64).reshape(count)
    except UNREADABLE:
        numbers = np.full(count, np.nan)
    if not np.isfinite(numbers).all():
        expected = "a finite number" if count == 1 else f"{count} finite numbers"
        raise PlateError(f"{attribute.GetName()} must be {expected}, got {format_value(value)}")
    return numbers


def plate_corners(camera: UsdGeom.Camera, time: Usd.TimeCode, *, shown_to_all: bool = False) -> DoubleArray:
    """Corners ``(n, 3)`` of a camera's plates in its space, scene units; plates that cannot be placed have none.

    Args:
        camera: the camera.
        time: USD time code.
        shown_to_all: leave out plates that other cameras do not see.
    """
    corners = [np.zeros((0, 3))]
    for name in plate_names(camera.GetPrim()):
        if shown_to_all and UsdGeom.BackPlateAPI(camera.GetPrim(), name).GetPlateVisibilityAttr().Get(time) != "all":
            continue
        try:
            matrix = read_plate_place(camera, name, time)
        except PlateError:
            continue  # the plate is not drawn, and the stage reader says so
        corners.append(CORNERS @ matrix[:3, :3].T + matrix[:3, 3])
    return np.concatenate(corners)


def _read_size(camera: UsdGeom.Camera, time: Usd.TimeCode) -> tuple[float, DoubleArray]:
    """Focus distance and the ``(2,)`` width and height of what the film gate sees there, scene units."""
    distance = _positive(camera.GetFocusDistanceAttr(), time)
    apertures = (camera.GetHorizontalApertureAttr(), camera.GetVerticalApertureAttr())
    gate = _TENTH * np.array([_positive(attribute, time) for attribute in apertures])
    if camera.GetProjectionAttr().Get(time) == UsdGeom.Tokens.orthographic:
        return distance, gate
    return distance, gate * distance / (_TENTH * _positive(camera.GetFocalLengthAttr(), time))


def _positive(attribute: Usd.Attribute, time: Usd.TimeCode) -> float:
    value = float(read_numbers(attribute, time, 1)[0])
    if value <= 0:
        raise PlateError(f"{attribute.GetName()} must be more than 0, got {value:g}")
    return value


def _turn(axis: int, degrees: float) -> DoubleArray:
    """Matrix ``(3, 3)`` that turns about an axis, counter-clockwise as seen from its tip."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    i, j = _AXES[axis]
    matrix = np.eye(3)
    matrix[i, i] = matrix[j, j] = cos
    matrix[i, j], matrix[j, i] = -sin, sin
    return matrix
