"""States of pictures: which frames an edit leaves as they are."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdGeom

from render.errors import CameraError
from render.model.content import digest_of
from render.shot import Shot
from render.shot.picture_state import picture_states
from tests.render.kits.focus_shot import CAMERA, FAR, FRAMES, NEAR, write_shot
from usd_schemas import FocusPoint

TIMES = [float(frame) for frame in FRAMES]


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    return Shot.open(write_shot(tmp_path / "shot.usda"))


def changed(shot: Shot, edit: Callable[[], object]) -> list[int]:
    """Frames whose state an edit changes."""
    before = picture_states(shot, None, TIMES)
    with shot.edits.transaction("edit"):
        edit()
    after = picture_states(shot, None, TIMES)
    return [int(time) for time, one, other in zip(TIMES, before, after, strict=True) if one != other]


def author(shot: Shot, path: str, name: str, type_name: Sdf.ValueTypeName, value: object) -> None:
    shot.stage.GetPrimAtPath(path).CreateAttribute(name, type_name).Set(value)


def test_equal_shots_have_equal_states(tmp_path: Path, shot: Shot) -> None:
    (tmp_path / "other").mkdir()
    other = Shot.open(write_shot(tmp_path / "other/shot.usda"))
    states = picture_states(shot, None, TIMES)
    assert states == picture_states(other, CAMERA, TIMES)
    assert None not in states


def test_a_key_changes_the_frames_that_it_bends(shot: Shot) -> None:
    focus = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focusDistance")

    def key(time: float, distance: float) -> Callable[[], object]:
        return lambda: focus.Set(distance, time)

    for time in (1.0, 12.0, 24.0):
        changed(shot, key(time, 3.0))
    assert changed(shot, key(24.0, 5.0)) == list(range(13, 25))
    assert changed(shot, key(24.0, 5.0)) == []


@pytest.mark.parametrize(
    ("name", "type_name", "value"),
    [
        ("fStop", Sdf.ValueTypeNames.Float, 5.6),
        ("exposure", Sdf.ValueTypeNames.Float, 1.0),
        ("horizontalAperture", Sdf.ValueTypeNames.Float, 24.0),
        ("film:metering:mode", Sdf.ValueTypeNames.Token, "spot"),
    ],
)
def test_what_is_set_for_all_time_changes_all_frames(
    shot: Shot, name: str, type_name: Sdf.ValueTypeName, value: object
) -> None:
    assert changed(shot, lambda: author(shot, CAMERA, name, type_name, value)) == list(FRAMES)


def test_a_point_changes_nothing_where_the_focus_is_set_by_hand(shot: Shot) -> None:

    def add() -> None:
        prim = shot.stage.GetPrimAtPath(CAMERA)
        prim.ApplyAPI("FocusPointAPI", "hero")
        prim.CreateAttribute("focusPoint:hero:weight", Sdf.ValueTypeNames.Double).Set(1.0)
        prim.CreateRelationship("focusPoint:hero:target").SetTargets([NEAR])

    assert changed(shot, add) == []


def test_a_point_that_follows_a_part_changes_what_it_focuses(shot: Shot) -> None:
    point = {"target": (FAR,), "face": 0, "barycentric": (0.5, 0.0, 0.5)}
    shot.focus.add_point(CAMERA, "far", FocusPoint("far", **point))

    def follow() -> None:
        shot.focus.update_point(CAMERA, "far", part="/World", bounds_point=(0.5, 0.5, 0.0))

    assert changed(shot, follow) == [], "the least depth of both cards is that of the far one"
    assert changed(shot, lambda: shot.focus.update_point(CAMERA, "far", bounds_point=(0.5, 0.5, 0.5))) == [*FRAMES]


def test_what_a_meter_exposes_depends_on_all_edits(shot: Shot) -> None:
    """It looks at the frames around it, and at a focus point where the camera says so."""
    focal_length = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focalLength")
    for time in (1.0, 12.0, 24.0):
        changed(shot, lambda at=time: focal_length.Set(50.0, at))  # type: ignore[misc]
    assert changed(shot, lambda: focal_length.Set(60.0, 24.0)) == list(range(13, 25))
    shot.stage.GetPrimAtPath(CAMERA).ApplyAPI("FilmAPI")
    author(shot, CAMERA, "film:metering:mode", Sdf.ValueTypeNames.Token, "average")
    assert changed(shot, lambda: focal_length.Set(70.0, 24.0)) == list(FRAMES)
    assert changed(shot, lambda: focal_length.Set(70.0, 24.0)) == []


@pytest.mark.parametrize("path", ["/World/nothing", "/World", "/", "//", "/a b"])
def test_what_is_no_camera_has_no_states(shot: Shot, path: str) -> None:
    with pytest.raises(CameraError, match="there is no camera at"):
        picture_states(shot, path, TIMES[:1])


def test_edits_of_other_prims_change_all_frames(shot: Shot) -> None:
    assert changed(shot, lambda: UsdGeom.Imageable(shot.stage.GetPrimAtPath(FAR)).MakeInvisible()) == list(FRAMES)


def test_a_camera_that_makes_no_picture_has_no_state(shot: Shot) -> None:
    shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focalLength").Set(-1.0)
    assert picture_states(shot, None, TIMES[:2]) == [None, None]


def test_digests_are_of_what_values_hold() -> None:
    ones, twos = np.ones(3), np.full(3, 2.0)
    assert digest_of((1, ones, {"a": None})) == digest_of((1, ones.copy(), {"a": None}))
    different = [
        ones,
        twos,
        ones.astype(np.float32),
        ones.reshape(3, 1),
        [1.0, 1.0, 1.0],
        (1, 2),
        ((1,), 2),
        "1",
        1,
        1.0,
    ]
    assert len({digest_of(value) for value in different}) == len(different)


@pytest.mark.parametrize("metering", ["manual", "average"])
def test_labels_of_points_change_no_picture(tmp_path: Path, metering: str) -> None:
    written = Shot.open(write_shot(tmp_path / "shot.usda"))
    written.focus.add_point(CAMERA, "near", FocusPoint("near", target=(NEAR,)))
    author(written, CAMERA, "film:metering:mode", Sdf.ValueTypeNames.Token, metering)
    written.stage.Export(str(tmp_path / "flat.usda"))
    shot = Shot.open(tmp_path / "flat.usda")  # whose edits have nothing of the camera yet
    for label in ("color", "group"):
        attribute = shot.stage.GetPrimAtPath(CAMERA).GetAttribute(f"focusPoint:near:{label}")
        assert changed(shot, lambda attribute=attribute: attribute.Set("teal")) == []
