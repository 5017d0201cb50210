"""Every kind of geometry, material and light on a stage of its own: it is drawn, and nothing is found fault with."""

from __future__ import annotations

from pathlib import Path

import pytest
from pxr import Usd

from render.stage import StageReader
from tests.render.kits.kinds import GEOMETRY, LIGHTS, MATERIALS, Author, kind_stage

KINDS = {**GEOMETRY, **MATERIALS, **LIGHTS}


@pytest.mark.parametrize("author", KINDS.values(), ids=list(KINDS))
def test_each_kind_is_drawn(tmp_path: Path, author: Author) -> None:
    is_light = author in LIGHTS.values()
    file = tmp_path / "kind.usda"
    kind_stage(file, author, booth=is_light)
    reader = StageReader(Usd.Stage.Open(str(file)))
    scene = reader.read(1.0)
    assert [finding.message for finding in reader.findings] == []
    assert any(path.startswith("/world/kind") for path in scene.prim_paths)
    assert [light.path for light in scene.lights] == ["/world/kind/light" if is_light else "/sun"]
