"""Every parameter of camera, lens and film may be keyed: between its keys it changes smoothly, in its own unit, and the picture
is made with what it is at that time. The list of them is the schemas' own, so that what is added is asked too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom

from render.shot.exposure.readout import read_exposure
from render.shot.film.finish import read_finish
from render.stage import read_camera
from usd_schemas import LensCamera
from usd_schemas.applying import apply
from usd_schemas.binding import property_values
from usd_schemas.registration import SINGLE_APPLY
from usd_schemas.values import usd_value

CAMERA = "/cam"
FIRST, MIDDLE, LAST = 1.0, 2.0, 3.0
VIEWS = {
    "LensAPI": "lens",
    "ApertureAPI": "aperture",
    "TiltShiftAPI": "tilt_shift",
    "FilmAPI": "film",
    "FocusAPI": "focus",
}
USD = {
    "focalLength": (0.35, 0.85),
    "horizontalAperture": (0.2, 0.36),
    "verticalAperture": (0.15, 0.24),
    "horizontalApertureOffset": (-0.05, 0.05),
    "verticalApertureOffset": (-0.05, 0.05),
    "fStop": (2.0, 8.0),
    "focusDistance": (1.5, 6.0),
    "exposure": (-1.0, 2.0),
    "exposure:time": (0.01, 0.04),
    "exposure:iso": (100.0, 800.0),
    "exposure:fStop": (2.0, 8.0),
    "exposure:responsivity": (0.5, 1.5),
    "shutter:open": (-0.4, -0.1),
    "shutter:close": (0.1, 0.4),
}
"""Attributes of UsdGeomCamera, with two values each."""

_SURFACES = {
    "lens:model": "prescription",
    "lens:prescription:radius": (0.0, 40.0, -40.0),
    "lens:prescription:thickness": (1.0, 2.0, 30.0),
    "lens:prescription:index": (1.0, 1.5, 1.0),
    "lens:prescription:clearDiameter": (9.0, 12.0, 12.0),
    "lens:prescription:stopSurface": 0,
}
_GLASS = {
    "lens:prescription:sellmeierB": ((0.0,) * 3, (1.04, 0.23, 1.01), (0.0,) * 3),
    "lens:prescription:sellmeierC": ((0.0,) * 3, (0.006, 0.02, 103.6), (0.0,) * 3),
}
_OUTLINES = {
    name: {
        f"lens:prescription:{name}Shape": ("ellipse", "", ""),
        f"lens:prescription:{name}Size": ((8.0, 6.0), (0.0, 0.0), (0.0, 0.0)),
    }
    for name in ("opening", "obscuration")
}
_KNOTS = tuple((x, 0.2 + 0.6 * (x + 2)) for x in (-2.0, -1.0, 0.0, 1.0))
_CURVES = {f"film:{kind}:{c}": _KNOTS for kind in ("curve", "printCurve") for c in ("red", "green", "blue")}
_NEGATIVE = {"film:process": "negative", "film:stock": "5219"}
_CONTEXTS: dict[str, dict[str, Any]] = {
    "lens:seidel:": {"lens:model": "seidel"},
    "lens:prescription:sellmeier": _SURFACES | _GLASS,
    "lens:prescription:opening": _SURFACES | _OUTLINES["opening"],
    "lens:prescription:obscuration": _SURFACES | _OUTLINES["obscuration"],
    "lens:prescription:": _SURFACES,
    "lens:expressive:channelIndex": _SURFACES,
    "film:curve:gamma": _NEGATIVE | {"film:curve:source": "parametric"},
    "film:curve:toe": _NEGATIVE | {"film:curve:source": "parametric"},
    "film:curve:shoulder": _NEGATIVE | {"film:curve:source": "parametric"},
    "film:curve:minDensity": _NEGATIVE | {"film:curve:source": "parametric"},
    "film:curve:maxDensity": _NEGATIVE | {"film:curve:source": "parametric"},
    "film:curve:": _NEGATIVE | _CURVES | {"film:curve:source": "knots"},
    "film:printCurve:": _NEGATIVE | _CURVES,
    "film:sensor:": {"film:process": "digital"},
    "film:shutter:": {"film:shutter:type": "rolling"},
    "film:grain:": _NEGATIVE | {"film:grain:amount": 1.0},
    "film:cdl:": {},
    "film:metering:": {},
    "film:": _NEGATIVE,
    "aperture:": {"aperture:blades": 6},
}
"""Further settings that a property needs to have an effect, by the start of its name; the first match counts."""

_VALUES: dict[str, tuple[Any, Any]] = {
    "lens:prescription:radius": ((0.0, 40.0, -40.0), (0.0, 44.0, -48.0)),
    "lens:prescription:radiusAcross": ((0.0, 60.0, -60.0), (0.0, 70.0, -50.0)),
    "lens:prescription:thickness": ((1.0, 2.0, 30.0), (1.4, 3.0, 30.0)),
    "lens:prescription:index": ((1.0, 1.5, 1.0), (1.0, 1.7, 1.0)),
    "lens:prescription:abbe": ((0.0, 60.0, 0.0), (0.0, 30.0, 0.0)),
    "lens:prescription:clearDiameter": ((9.0, 12.0, 12.0), (8.0, 10.0, 14.0)),
    "lens:prescription:conic": ((0.0, 0.0, 0.0), (0.0, -1.0, 0.5)),
    **{
        f"lens:prescription:{outline}Size": (((8.0, 6.0), (0.0, 0.0), (0.0, 0.0)), ((6.0, 8.0), (0.0, 0.0), (0.0, 0.0)))
        for outline in ("opening", "obscuration")
    },
    **{
        f"lens:prescription:{outline}Centre": (
            ((0.5, 1.0), (0.0, 0.0), (0.0, 0.0)),
            ((1.0, 0.0), (0.0, 0.0), (0.0, 0.0)),
        )
        for outline in ("opening", "obscuration")
    },
    "lens:prescription:sellmeierB": (_GLASS["lens:prescription:sellmeierB"], ((0.0,) * 3, (1.3, 0.2, 1.0), (0.0,) * 3)),
    "lens:prescription:sellmeierC": (
        _GLASS["lens:prescription:sellmeierC"],
        ((0.0,) * 3, (0.01, 0.04, 99.0), (0.0,) * 3),
    ),
    "lens:expressive:channelIndex": ((1.5, 1.52, 1.55), (1.4, 1.5, 1.7)),
    "lens:expressive:pupilPower": ((1.0, 1.2), (1.4, 0.8)),
    "aperture:radialWeights": ((1.0, 0.5), (0.2, 0.9)),
    "film:shutter:efficiency": ((0.0, 1.0, 0.0), (0.5, 1.0, 0.5)),
    "splitDiopter:count": (1, 2),
    "film:push": (-1.0, 2.0),
    "film:halation:color": ((1.0, 0.3, 0.1), (0.5, 0.4, 0.3)),
    "film:cdl:offset": ((0.0, 0.0, 0.0), (0.1, -0.1, 0.2)),
    "film:metering:spot": ((0.2, 0.3), (0.6, 0.9)),
    "lens:fStopRange": ((2.0, 22.0), (2.8, 16.0)),
}
_OF_PICTURES = ("lens:", "aperture:", "film:")
_ELSEWHERE = {
    "lens:heightField:": "needs images; `test_height_field_scales`",
    "lens:table:": "`test_data_sheet`",
    "lens:flare:": "drawn over the picture",
    "lens:focusThrow": "bounds the speed of racks",
    "lens:fStopRange": "bounds the solver of the stop, and completes a prescription",
    "lens:entrancePupilOffset": "is not honoured, and `inspect` says so",
    "lens:prescription:coatingWavelength": "of ghosts",
    "aperture:mask": "an image",
    "film:metering:": "`test_light_meter`",
}
"""Properties that neither the camera nor the finish of a picture hold, and why."""


def properties() -> list[str]:
    """All properties of the schemas that may change over time."""
    registry = Usd.SchemaRegistry()
    return [
        name
        for schema in SINGLE_APPLY
        for definition in [registry.FindAppliedAPIPrimDefinition(schema)]
        for name in definition.GetPropertyNames()
        if (spec := definition.GetSchemaAttributeSpec(name)) and spec.variability != Sdf.VariabilityUniform
    ]


def camera_with(**values: Any) -> LensCamera:
    """A camera that says so, in metres; it keeps its stage alive."""
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    camera = LensCamera(UsdGeom.Camera.Define(stage, CAMERA).GetPrim())
    for schema in SINGLE_APPLY:
        apply(camera.prim, schema)
    gate = {
        "focalLength": 0.5,
        "horizontalAperture": 0.36,
        "verticalAperture": 0.24,
        "fStop": 4.0,
        "focusDistance": 3.0,
    }
    for name, value in (gate | values).items():
        put(camera, name, value)
    camera.kept = stage  # type: ignore[attr-defined]
    return camera


def put(camera: LensCamera, name: str, value: Any) -> None:
    """Hold a value for all time."""
    attribute = camera.prim.GetAttribute(name)
    attribute.Set(usd_value(attribute, value))


def two_values(name: str) -> tuple[Any, Any]:
    """Two values that a property may have."""
    if name in USD or name in _VALUES:
        return (USD | _VALUES)[name]
    camera = camera_with()
    attribute = camera.prim.GetAttribute(name)
    kind = str(attribute.GetTypeName())
    if kind in ("double", "float"):
        soft, hard = attribute.GetSoftLimits(), attribute.GetHardLimits()
        ends = [soft.GetMinimum(), soft.GetMaximum(), hard.GetMinimum(), hard.GetMaximum()]
        low = ends[0] if ends[0] is not None else ends[2] if ends[2] is not None else 0.0
        high = ends[1] if ends[1] is not None else ends[3] if ends[3] is not None else low + 1
        return low + 0.25 * (high - low), low + 0.75 * (high - low)
    return {
        "bool": (False, True),
        "int": (5, 7),
        "token": ("", ""),
        "asset": ("one.png", "two.png"),
        "double2": ((0.1, 0.2), (0.3, 0.6)),
        "float2": ((0.1, 0.2), (0.3, 0.6)),
        "double3": ((0.8, 0.9, 1.0), (1.0, 1.2, 1.4)),
        "color3d": ((0.8, 0.9, 1.0), (1.0, 1.2, 1.4)),
        "double[]": ((0.1, 0.2, 0.3), (0.3, 0.1, 0.5)),
        "double2[]": (_KNOTS, tuple((x + 0.1, y + 0.2) for x, y in _KNOTS)),
        "double3[]": (((0.1, 0.2, 0.3),), ((0.3, 0.2, 0.5),)),
    }[kind]


def between(first: Any, last: Any) -> Any:
    """Half way, where there is such a thing; else the first."""
    if isinstance(first, bool | int | str):
        return first
    if isinstance(first, tuple):
        return tuple(between(a, b) for a, b in zip(first, last, strict=True))
    return (first + last) / 2


def keyed(camera: LensCamera, name: str) -> None:
    """Two keys; numbers are joined by the native spline, what is larger by its samples."""
    for time, value in zip((FIRST, LAST), two_values(name), strict=True):
        camera.set_key(name, time, value, "held" if isinstance(value, bool | int | str) else "linear")


@pytest.mark.parametrize("name", [name for name in properties() if not name.endswith("lensDistortion:type")])
def test_each_parameter_is_interpolated_between_keys_in_its_unit(name: str) -> None:
    camera = camera_with()
    keyed(camera, name)
    first, last = two_values(name)
    attribute = camera.prim.GetAttribute(name)
    seen = [
        dict(pair for view in VIEWS.values() for pair in property_values(getattr(camera, view).read(time)))[name]
        for time in (FIRST, MIDDLE, LAST)
    ]
    plain = [getattr(value, "path", value) for value in seen]
    if isinstance(first, str | bool | int):
        assert plain == [first, first, last]
    else:
        for got, expected in zip(plain, (first, between(first, last), last), strict=True):
            np.testing.assert_allclose(got, expected, rtol=1e-6)
    assert attribute.HasSpline() == (str(attribute.GetTypeName()) in ("double", "float"))


def leaves(value: Any) -> Iterator[Any]:
    """All numbers and words within."""
    if is_dataclass(value):
        for item in fields(value):
            yield from leaves(getattr(value, item.name))
    elif isinstance(value, np.ndarray):
        yield from value.ravel().tolist()
    elif isinstance(value, dict):
        yield from leaves(list(value.items()))
    elif isinstance(value, list | tuple):
        yield len(value)
        for item in value:
            yield from leaves(item)
    else:
        yield value


def made_with(camera: LensCamera, time: float) -> list[Any]:
    """All that a picture at a time is made with."""
    stage = camera.prim.GetStage()
    seen = read_camera(stage, CAMERA, time)
    finish = read_finish(stage, seen, time)
    return [*leaves(seen), *leaves(finish), *leaves(read_exposure(stage, seen, time).settings)]


def same(one: list[Any], other: list[Any]) -> bool:
    if len(one) != len(other):
        return False
    return all(
        a == pytest.approx(b, rel=1e-5, abs=1e-9) if isinstance(a, float) and isinstance(b, float) else a == b
        for a, b in zip(one, other, strict=True)
    )


def of_pictures() -> list[str]:
    known = [name for name in properties() if name.startswith(_OF_PICTURES)]
    return [*USD, *(name for name in known if not name.startswith(tuple(_ELSEWHERE)))]


@pytest.mark.parametrize("name", of_pictures())
def test_a_picture_is_made_with_what_a_parameter_is_at_its_time(name: str) -> None:
    context = next((said for start, said in _CONTEXTS.items() if name.startswith(start)), {})
    moving, still = camera_with(**context), camera_with(**context)
    keyed(moving, name)
    first, last = two_values(name)
    put(still, name, between(first, last))
    assert same(made_with(moving, MIDDLE), made_with(still, MIDDLE))
    assert not same(made_with(moving, FIRST), made_with(moving, LAST))


@pytest.mark.parametrize("name", ["fStop", "focusDistance", "exposure", "film:push", "lens:neutralDensity"])
def test_eased_keys_of_stops_and_distances_change_without_a_jump(name: str) -> None:
    camera = camera_with()
    first, last = two_values(name)
    for time, value in ((FIRST, first), (25.0, last), (49.0, first)):
        camera.set_key(name, time, value, "auto")
    values = np.array([camera.prim.GetAttribute(name).Get(t) for t in np.arange(1, 49.01, 0.25)])
    steps = np.diff(values) / (last - first)
    assert np.abs(steps).max() < 0.02  # twice an even pace
    assert np.abs(np.diff(steps)).max() < 2e-3
    assert values.min() >= min(first, last) - 1e-5
    assert values.max() <= max(first, last) + 1e-5
