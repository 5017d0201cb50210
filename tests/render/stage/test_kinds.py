"""Every kind of geometry, material and light on a stage of its own: all are drawn, and nothing is found fault with."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd

from render.stage import StageReader
from tests.render.kits.kinds import GEOMETRY, LIGHTS, MATERIALS, Author, kinds_stage


@pytest.mark.parametrize(("kinds", "booths"), [(GEOMETRY, False), (MATERIALS, False), (LIGHTS, True)])
def test_each_kind_is_drawn(tmp_path: Path, kinds: dict[str, Author], booths: bool) -> None:
    file = tmp_path / "kinds.usda"
    kinds_stage(file, kinds, booths=booths)
    reader = StageReader(Usd.Stage.Open(str(file)))
    scene = reader.read(1.0)
    drawn = {path.split("/")[2] for path in scene.prim_paths if path.startswith("/cells")}
    drawn |= {path.split("/")[2] for path in scene.material_paths if path.startswith("/cells")}
    named = {finding.message for finding in reader.findings if finding.code != "shadow_maps"}
    assert named == set()
    assert drawn == {f"cell_{number:02}" for number in range(len(kinds))}
    assert len(scene.splats) == (kinds is GEOMETRY)
    assert not booths or len({light.path for light in scene.lights}) >= len(kinds)
