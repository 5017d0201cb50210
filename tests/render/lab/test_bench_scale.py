"""`pullfocus bench scale` measures each case in a process of its own, fits how costs grow, and outlives hopeless cases."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from render.lab.bench.scale.plan import SceneSize
from render.lab.bench.scale.run import MEASURES, ScaleRow, growth_of
from render.lab.bench.scale.stage import write_stage
from render.shot import Shot
from tests.render.kits.cli_shots import Command


@pytest.mark.gl
def test_quick_cases_are_measured(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "scale.json"
    ended = Command(capsys)("bench", "scale", "--quick", "--axis", "instances", "--json", file)
    assert ended.status == 0
    found = json.loads(file.read_text())
    assert [(row["axis"], row["value"], row["outcome"]) for row in found["rows"]] == [
        ("instances", 100, "done"),
        ("instances", 1000, "done"),
    ]
    few, many = found["rows"]
    assert many["drawn_triangles"] - few["drawn_triangles"] == 4 * 900
    for row in (few, many):
        assert 0 < row["open_s"] < row["first_s"]
        assert row["frame_s"] > 0
        assert row["memory_mb"] > 50
        assert row["sketch_s"] > 0
        assert row["whole_s"] > 0
    assert len(found["growth"]) == len(MEASURES)
    assert "exponent" in ended.out


@pytest.mark.gl
@pytest.mark.parametrize(("limit", "outcome"), [("--timeout", "timeout"), ("--memory", "memory")])
def test_a_hopeless_case_is_ended_and_told(limit: str, outcome: str, capsys: pytest.CaptureFixture[str]) -> None:
    ended = Command(capsys)("bench", "scale", "--quick", "--axis", "prims", "--most", "10", limit, "0.001")
    assert ended.status == 0
    assert outcome in ended.out


def test_exponents_are_those_of_power_laws() -> None:
    powers = dict(zip(MEASURES, (1, 1, 0, 0, 2, 2, 0.5, 0.25, 0.25, 0.75, 0.75), strict=True))
    rows = [
        ScaleRow("prims", n, SceneSize(prims=n), "done", **{name: 0.1 * n**power for name, power in powers.items()})
        for n in (10, 100, 1000)
    ]
    rows.append(ScaleRow("prims", 10_000, SceneSize(prims=10_000), "timeout"))
    slopes = {one.measure: (one.exponent, one.at_end) for one in growth_of(rows)}
    for measure, exponent in powers.items():
        assert slopes[measure] == pytest.approx((exponent, exponent), abs=1e-6)
    assert all(one.exponent is None for one in growth_of(rows[-1:]))


def test_stages_are_of_the_size_that_is_asked_for(tmp_path: Path) -> None:
    size = SceneSize(triangles=6_000, prims=12, instances=50, natives=70, movers=30, lights=3)
    shot = Shot.open(write_stage(tmp_path, size))
    scene = shot.scene_at(1.0)
    (tmp_path / "plain").mkdir()
    plain = Shot.open(write_stage(tmp_path / "plain", SceneSize(triangles=6_000, prims=12, lights=3))).scene_at(1.0)
    assert plain.triangle_count == pytest.approx(6_000, rel=0.05)
    assert scene.triangle_count - plain.triangle_count == 4 * (50 + 70 + 30)
    assert len([prim for prim in shot.stage.Traverse() if prim.IsInstance()]) == 70
    later = shot.scene_at(2.0)
    assert sum(one is not other for one, other in zip(scene.batches, later.batches, strict=True)) == 30
    assert len(scene.lights) == 3
    assert len({path for path in scene.prim_paths if "/meshes/" in path}) == 12
