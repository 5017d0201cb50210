"""A focus point that is renamed keeps all that it says."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdGeom

from usd_schemas import FocusPoint, LensCamera
from usd_schemas.errors import SchemaError
from usd_schemas.keys import Tangents


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    anchor = {"target": ("/World/Pip/Head",), "face": 3, "barycentric": (0.2, 0.3, 0.5)}
    subject = {"part": "/World/Pip", "bounds_point": (0.5, 0.9, 0.5)}
    point = FocusPoint("pip", **anchor, **subject, weight=0.5, kind="soft")
    view = camera.add_focus_point("pip", point)
    view.set_key("weight", 10, 1.0, "bezier", Tangents(0.0, 2.0, -0.1, 3.0))
    view.set_key("weight", 20, 0.25, "auto")
    view.set_key("enabled", 5, True, "held")
    camera.add_focus_point("mara", FocusPoint("mara", target=("/World/Mara",)))
    return camera


def test_values_and_keys_stay(camera: LensCamera) -> None:
    old = camera.focus_point("pip")
    values = [vars(old.read(time)) | {"name": ""} for time in (None, 5, 12.5, 20)]
    keys = {name: old.keys(name) for name in ("weight", "enabled", "blur")}
    new = camera.rename_focus_point("pip", "robot")
    assert [point.name for point in camera.focus_points()] == ["mara", "robot"]
    assert [vars(new.read(time)) | {"name": ""} for time in (None, 5, 12.5, 20)] == values
    assert {name: new.keys(name) for name in keys} == keys
    assert not [name for name in camera.prim.GetPropertyNames() if ":pip:" in name]


def test_samples_of_a_weaker_layer_stay(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usda"))
    camera = LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())
    camera.add_focus_point("pip", FocusPoint("pip", target=("/World/Pip",)))
    weight = camera.prim.GetAttribute("focusPoint:pip:weight")
    for time, value in ((1, 1.0), (10, 0.5)):
        weight.Set(value, time)
    stage.Save()
    over = Usd.Stage.Open(str(tmp_path / "shot.usda"))
    over.SetEditTarget(over.GetSessionLayer())
    edited = LensCamera(over.GetPrimAtPath("/cam"))
    new = edited.rename_focus_point("pip", "robot")
    assert [point.name for point in edited.focus_points()] == ["robot"]
    assert [new.read(time).weight for time in (1, 5.5, 10)] == [1.0, 0.75, 0.5]
    assert Sdf.Layer.Find(str(tmp_path / "shot.usda")).GetPropertyAtPath("/cam.focusPoint:pip:weight")


@pytest.mark.parametrize(("name", "new_name"), [("pip", "mara"), ("pip", "a b"), ("pip", ""), ("nobody", "robot")])
def test_what_cannot_be_is_refused_and_leaves_all(
    stage: Usd.Stage, camera: LensCamera, name: str, new_name: str
) -> None:
    before = stage.ExportToString()
    with pytest.raises(SchemaError):
        camera.rename_focus_point(name, new_name)
    assert stage.ExportToString() == before


def test_a_colour_that_does_not_exist_holds_nothing_up(camera: LensCamera) -> None:
    point = camera.focus_point("pip")
    color = camera.prim.GetAttribute("focusPoint:pip:color")
    color.Set("mauve")
    point.author(replace(point.read(), part=""))
    assert (point.read().part, color.Get()) == ("", "mauve")
    with pytest.raises(SchemaError, match="color"):
        point.author(replace(point.read(), color="puce"))
    assert camera.rename_focus_point("pip", "robot").read().color == "none"
