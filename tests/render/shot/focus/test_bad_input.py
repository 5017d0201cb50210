"""A fault of one focus point, or a request for too many, leaves the others to focus the shot."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Gf, Usd

from render.errors import CameraError
from render.shot import Shot
from render.shot.inspection import inspect_shot
from render.shot.lens.lens_choice import choose_lens
from tests.render.kits.table_shot import CAMERA, ON_TABLE, TABLE, on_table, write_table


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    made = Shot.open(write_table(tmp_path / "table.usda"))
    for name, place in ON_TABLE.items():
        made.focus.add_point(CAMERA, name, on_table(name, place))
    return made


def say(shot: Shot, name: str, value: Any, time: float | None = None) -> None:
    """Author a value past every check, as a file of another tool may have it."""
    with Usd.EditContext(shot.stage, shot.edits.layer):
        attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute(name)
        attribute.Set(value) if time is None else attribute.Set(value, time)


def codes(shot: Shot) -> list[str]:
    return [finding.code for finding in shot.findings()]


@pytest.mark.parametrize("mode", ["points", "tiltPlane", "surface"])
@pytest.mark.parametrize(
    ("field", "value", "told"),
    [
        ("weight", math.nan, "the weight of focus point 'near' must be a finite number of 0 or more, but it is nan"),
        ("weight", -1.0, "but it is -1"),
        ("blur", math.inf, "the blur in mm of focus point 'near'"),
        ("extent", 0.0, "the extent of focus point 'near' must be a finite number of 0.001 or more, but it is 0"),
        ("surfaceOffset", math.nan, "the surface offset in m of focus point 'near' must be a finite number, but"),
        (
            "offset",
            Gf.Vec3d(math.nan, 0, 0),
            "the offset of focus point 'near' must be finite numbers, but they are (nan",
        ),
        ("kind", "hazy", "focus point 'near' must be sharp or soft, but it is 'hazy'"),
    ],
)
def test_a_point_that_is_at_fault_is_left_out_and_named(
    shot: Shot, mode: str, field: str, value: Any, told: str
) -> None:
    shot.focus.set(CAMERA, mode=mode)
    say(shot, f"focusPoint:near:{field}", value)
    with_fault = shot.focus.read(CAMERA, 1)
    states = {point.point.name: point.state for point in shot.focus.points(CAMERA, 1)}
    assert states == {"near": "lost", "left": "used", "far": "used"}
    (near,) = (point.point for point in shot.focus.points(CAMERA, 1) if point.point.name == "near")
    sound = {"offset": (0.0, 0.0, 0.0)} if field == "offset" else {}
    assert replace(near, topology="") == replace(on_table("near", ON_TABLE["near"]), **sound)  # nothing to stumble over
    (finding,) = (finding for finding in shot.findings() if finding.code == "bad_focus_point")
    assert told in finding.message
    assert "the other points decide the focus" in finding.message
    shot.focus.remove_point(CAMERA, "near")
    assert with_fault == shot.focus.read(CAMERA, 1)
    assert "bad_focus_point" not in codes(shot)


def test_a_key_that_is_at_fault_is_so_only_at_its_times(shot: Shot) -> None:
    whole = shot.focus.read(CAMERA, 1).focus_distance_m
    say(shot, "focusPoint:near:weight", 1.0, 1)
    say(shot, "focusPoint:near:weight", -1.0, 10)
    curve = shot.focus.curve(CAMERA, [1.0, 2.0, 10.0])
    assert curve.focus_distance_m[0] == pytest.approx(whole)
    assert curve.points[0].states == ("used", "used", "lost")
    assert np.isfinite(curve.points[0].weight).all()


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("focus:expressive", math.nan, "focus:expressive of camera /World/cam must be finite, got nan"),
        ("focus:expressive", 2.0, "must be at most 1, got 2"),
        ("focus:lag", -1.0, "focus:lag of camera /World/cam must be at least 0, got -1"),
        ("focus:occluded", "sometimes", "must be one of ignore, keep, fade, got 'sometimes'"),
        ("focus:offScreen", "sometimes", "focus:offScreen of camera /World/cam must be one of"),
        ("focus:mode", "sometimes", "focus:mode of camera /World/cam must be one of manual, points"),
        ("focus:circleOfConfusion", math.nan, "focus:circleOfConfusion of camera /World/cam must be finite"),
    ],
)
def test_impossible_settings_are_named_where_points_focus(shot: Shot, name: str, value: Any, told: str) -> None:
    shot.focus.set(CAMERA, mode="surface")
    say(shot, name, value)
    with pytest.raises(CameraError, match=told):
        shot.focus.read(CAMERA, 1)
    shot.focus.set(CAMERA, mode="manual")
    assert shot.focus.read(CAMERA, 1).focus_distance_m == pytest.approx(1.8)


@pytest.mark.parametrize(("count", "is_told"), [(64, False), (70, True)])
def test_a_surface_takes_the_strongest_of_too_many_points(shot: Shot, count: int, is_told: bool) -> None:
    for name in ON_TABLE:
        shot.focus.remove_point(CAMERA, name)
    for i in range(count):  # the first six are the weakest
        place = (0.02 * (i % 10) - 0.1, 0.0, 0.1 * (i // 10) - 0.4)
        shot.focus.add_point(CAMERA, f"p{i}", on_table(f"p{i}", place, weight=1.0 if i < 6 else 2.0))
    shot.focus.set(CAMERA, mode="surface")
    blurs_mm = np.array([point.coc_mm for point in shot.focus.points(CAMERA, 1)])
    assert blurs_mm[6:] == pytest.approx(0, abs=1e-9)
    assert (blurs_mm[:6] > 1e-6).all() == is_told
    told = [finding.message for finding in shot.findings() if finding.code == "focus_not_as_asked"]
    assert told == (
        [f"{CAMERA}: a focal surface has room for 64 focus points, so only the strongest shape it"] * is_told
    )
    assert shot.focus.curve(CAMERA, [1.0]).limited[0] == is_told


def test_a_deactivated_target_is_lost(shot: Shot) -> None:
    with Usd.EditContext(shot.stage, shot.stage.GetRootLayer()):
        shot.stage.GetPrimAtPath(TABLE).SetActive(False)
    states = [point.state for point in shot.focus.points(CAMERA, 1)]
    assert states == ["lost"] * 3
    assert f"focus point near is on {TABLE}, which is deactivated" in shot.findings()[0].message


def test_a_focus_out_of_the_lenss_reach_leaves_the_shot_readable(shot: Shot) -> None:
    shot.camera.mount_lens(CAMERA, choose_lens("planar_50"))
    shot.camera.set(CAMERA, focus_distance_m=0.02)
    seen = inspect_shot(shot)
    assert "cannot focus at 0.02 m" in " ".join(note.message for note in seen.notes)
    assert (seen.readouts, seen.prim_count) == ((), 10)


def test_a_lens_tilted_as_far_as_it_may_be_is_written_as_a_layer(shot: Shot) -> None:
    shot.focus.set(CAMERA, tilt_deg=89.0, driven_by_points=False)
    layer = shot.focus.layer(CAMERA, [1.0, 2.0])
    assert "tiltShift:tilt" in layer


def test_keys_of_what_is_the_same_at_all_times_say_nothing(tmp_path: Path) -> None:
    """A frame has one focus, whether it is asked for alone or with others."""
    shot = Shot.open(write_table(tmp_path / "table.usda"))
    shot.focus.add_point(CAMERA, "far", on_table("far", ON_TABLE["far"]))
    with Usd.EditContext(shot.stage, shot.edits.layer):
        mode = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focus:mode")
        mode.Set("manual", 10.0)
        mode.Set("points", 1.0)
    alone = [shot.focus.read(CAMERA, time).focus_distance_m for time in (1, 12)]
    assert shot.focus.curve(CAMERA, [1, 12]).focus_distance_m.tolist() == alone
