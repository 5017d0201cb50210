"""Layers that other tools got wrong: they are read without a fall, and what is wrong with them is named."""

from __future__ import annotations

import pytest
from pxr import Sdf, Usd

from usd_schemas import FocusPoint, Key, LensCamera, LensData
from usd_schemas.validation import validate

MALFORMED = """#usda 1.0

def Mesh "mesh"
{
    int[] faceVertexCounts = None
    string faceVertexIndices = "nonsense"
}

def Camera "cam" (
    apiSchemas = ["LensAPI", "ApertureAPI", "FilmAPI", "FocusAPI", "FocusPointAPI:a", "FocusPointAPI:b"]
)
{
    string focalLength = "fifty"
    float fStop = None
    float2 clippingRange.timeSamples = { 1: None, 2: (3, 1) }
    string shutter:close = "late"
    string lens:name = None
    float lens:squeeze = 2
    double lens:transmittance.timeSamples = { 1: None, 2: 7 }
    double[] lens:prescription:index = None
    string lens:prescription:radius = "round"
    string aperture:blades = "seven"
    double2[] film:curve:red = None
    string focus:smoothing = "a bit"
    double3 focusPoint:a:barycentric = None
    rel focusPoint:a:target = [</mesh>, </cam.focusPoint:a:target>]
    string focusPoint:a:face = "left"
    string focusPoint:b:topology = "0123"
    rel focusPoint:b:target = </mesh>
    int focusPoint:b:face = 3
    int focusPoint:b:instance.timeSamples = { 1: None }
}
"""


@pytest.fixture
def stage() -> Usd.Stage:
    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.ImportFromString(MALFORMED)
    return Usd.Stage.Open(layer)


@pytest.mark.parametrize("time", [None, 1.0, 2.0])
def test_values_of_another_type_read_as_the_fallback(stage: Usd.Stage, time: float | None) -> None:
    camera = LensCamera(stage.GetPrimAtPath("/cam"))
    lens = camera.lens.read(time)
    assert (lens.name, lens.prescription) == ("", LensData().prescription)
    assert camera.aperture.read(time).blades == 0
    assert camera.focus.read(time).smoothing_s == 0.0
    assert camera.film.read(time).curve.red == ()
    point = camera.focus_point("a").read(time)
    assert (point.face, point.barycentric) == (-1, FocusPoint("a").barycentric)


def test_another_precision_is_read(stage: Usd.Stage) -> None:
    assert LensCamera(stage.GetPrimAtPath("/cam")).lens.read().squeeze == 2.0


def test_a_blocked_sample_is_no_key(stage: Usd.Stage) -> None:
    camera = LensCamera(stage.GetPrimAtPath("/cam"))
    assert camera.keys("lens:transmittance") == [Key(2, 7.0, "linear")]
    assert camera.lens.read(1).transmittance == 1.0
    camera.set_key("lens:transmittance", 4, 0.5)
    assert camera.keys("lens:transmittance") == [Key(2, 7.0, "linear"), Key(4, 0.5, "linear")]


def test_what_is_wrong_is_named(stage: Usd.Stage) -> None:
    found = {(problem.rule, problem.path.removeprefix("/cam.")) for problem in validate(stage)}
    wrong_types = {path for rule, path in found if rule == "AuthoredTypes"}
    assert wrong_types == {
        "focalLength",
        "shutter:close",
        "lens:squeeze",
        "lens:prescription:radius",
        "aperture:blades",
        "focus:smoothing",
        "focusPoint:a:face",
    }
    assert {entry for entry in found if entry[0] != "AuthoredTypes"} == {
        ("CameraNumbers", "clippingRange"),
        ("ValuesAllowed", "lens:transmittance"),
        ("FocusPointTargets", "focusPoint:a:target"),
        ("FocusPointAnchors", "focusPoint:b:face"),
        ("FocusPointTopology", "focusPoint:b:topology"),
    }
