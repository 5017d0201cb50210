"""Reading many times at once gives the same as reading each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import pytest
from pxr import Gf, Usd

from usd_schemas import FocusData, FocusPoint, LensCamera, LensData, SplitDiopter, TiltShiftData, define_camera

TIMES = [1.0, 2.5, 7.0]


@pytest.fixture
def camera() -> Iterator[LensCamera]:
    stage = Usd.Stage.CreateInMemory()
    camera = define_camera(stage, "/cam")
    camera.lens.author(LensData(name="Singlet", split_diopter=SplitDiopter(count=1)))
    camera.focus.author(FocusData(mode="points"))
    camera.tilt_shift.author(TiltShiftData(tilt_deg=3.0))
    camera.add_focus_point("hero", FocusPoint("hero", ("/subject",), face=4, barycentric=(0.2, 0.3, 0.5)))
    yield camera  # noqa: PT022  (the stage lives as long)


def test_what_is_animated_is_read_at_each_time(camera: LensCamera) -> None:
    camera.set_key("splitDiopter:offset1", 1.0, -0.5)
    camera.set_key("splitDiopter:offset1", 7.0, 0.5)
    camera.set_key("focus:lag", 1.0, 0.0)
    camera.set_key("focus:lag", 7.0, 0.4)
    hero = camera.focus_point("hero")
    hero.set_key("weight", 2.0, 0.0)
    hero.set_key("weight", 7.0, 1.0)
    hero.set_key("enabled", 2.0, False, "held")
    camera.prim.GetAttribute("focusPoint:hero:offset").Set(Gf.Vec3d(0, 1, 0), 7.0)
    for view in (camera.lens, camera.focus, camera.tilt_shift, hero):
        at_each = tuple(view.read(time) for time in TIMES)
        assert view.read_over(TIMES) == at_each
        assert view.read_over(TIMES[::-1]) == at_each[::-1]
        assert (len(set(map(repr, at_each))) > 1) == (view is not camera.tilt_shift)


def test_unapplied_schemas_and_no_times_are_read_too(camera: LensCamera) -> None:
    assert camera.focus.read_over([]) == ()
    camera.prim.RemoveAppliedSchema("TiltShiftAPI")
    assert camera.tilt_shift.read_over(TIMES) == (TiltShiftData(),) * len(TIMES)
    assert camera.focus.read_over(TIMES) == (replace(FocusData(), mode="points"),) * len(TIMES)
