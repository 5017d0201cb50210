"""Focus points as REST has them."""

from __future__ import annotations

from pathlib import Path

from render.shot import Shot
from service.stage.read_points import read_points
from tests.render.kits.focus_shot import CAMERA, NEAR, write_shot
from usd_schemas import FocusPoint


def test_a_colour_that_does_not_exist_is_none(tmp_path: Path) -> None:
    shot = Shot.open(write_shot(tmp_path / "shot.usda"))
    shot.focus.add_point(CAMERA, "near", FocusPoint("near", target=(NEAR,)))
    for color, shown in (("pink", "pink"), ("mauve", "none")):
        shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focusPoint:near:color").Set(color)
        assert [point.color for point in read_points(shot, CAMERA, 1.0)] == [shown]
