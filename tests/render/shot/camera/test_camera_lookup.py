"""The list of a shot's cameras: kept between pictures, and right after each edit."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Sdf, UsdGeom

from render.shot import Shot
from render.shot.camera import lookup
from tests.render.kits.moving_shots import write_posts_shot


def test_cameras_are_listed_once_until_prims_come_or_go(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls = []
    plain = lookup.list_cameras
    monkeypatch.setattr(lookup, "list_cameras", lambda stage: calls.append(stage) or plain(stage))
    write_posts_shot(tmp_path / "room.usda").Save()
    shot = Shot.open(tmp_path / "room.usda")
    before = shot.cameras()
    for step in range(5):
        shot.camera.set("/cam", focus_distance_m=2.0 + step)
        shot.camera_at(None, 1.0, 16, 9)
    assert len(calls) <= 2, "the first edit below a prim may count as a new prim"
    with shot.edits.transaction("add a camera"):
        UsdGeom.Camera.Define(shot.stage, "/another")
    assert sorted(shot.cameras()) == sorted([*before, "/another"])
    with shot.edits.transaction("hide it"):
        shot.stage.GetPrimAtPath("/another").SetActive(False)
    assert shot.cameras() == before
    with shot.edits.transaction("bring it back under another name"):
        shot.stage.GetPrimAtPath("/another").SetActive(True)
        edit = Sdf.BatchNamespaceEdit()
        edit.Add("/another", "/second")
        assert shot.stage.GetEditTarget().GetLayer().Apply(edit)
    assert sorted(shot.cameras()) == sorted([*before, "/second"])
