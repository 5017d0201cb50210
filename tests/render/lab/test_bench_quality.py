"""`pullfocus bench quality` measures noise, bias and cost of two checkouts, and keeps its converged pictures."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import render
from render.lab.bench.quality.checkout import code_digest
from render.lab.bench.quality.results import NOTHING, Likeness, QualityRow, judge
from tests.render.kits.cli_shots import Command

ROOT = Path(render.__file__).parents[1]


@pytest.mark.gl
def test_two_checkouts_are_compared_with_kept_references(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "quality.json"
    typed = ("bench", "quality", "--quick", "--scene", "bars", "--before", ROOT, "--references", tmp_path)

    ended = Command(capsys)(*typed, "--json", file)

    assert ended.status == 0
    found = json.loads(file.read_text())
    rows = found["rows"]
    assert [(row["checkout"], row["rays"]) for row in rows] == [
        (which, rays) for rays in (4, 16) for which in ("before", "after")
    ]
    for before, after in zip(rows[::2], rows[1::2], strict=True):  # the same code
        assert before["bias"] == after["bias"]
        assert before["noise"] == after["noise"]
    few, many = rows[0], rows[2]
    for kind in ("noise", "bias"):
        assert few[kind]["psnr_db"] < many[kind]["psnr_db"]
        assert few[kind]["flip"] > many[kind]["flip"]
        assert 0.01 < many[kind]["worst_share"] < 1
    assert min(row[cost] for row in rows for cost in ("seconds", "cpu_s", "kept_s")) > 0
    assert found["goals"] == []  # they are set for larger pictures
    assert ended.out.count("bars") == len(rows) + 1
    (kept,) = tmp_path.glob("bars_*.npz")
    made = kept.stat().st_mtime_ns
    assert Command(capsys)(*typed, "--rays", "1").status == 0
    assert kept.stat().st_mtime_ns == made


def measured(subject: str, checkout: str, rays: int, *, noise_db: float, bias_db: float, seconds: float) -> QualityRow:
    like = Likeness(noise_db, 0.99, 0.01, 0.3)
    width = 480 if subject == "demo_64" else 640
    bias = replace(like, psnr_db=bias_db)
    return QualityRow(subject, checkout, width, 270, rays, like, bias, seconds, seconds, seconds)


def test_goals_say_what_holds() -> None:
    before = measured("demo_64", "before", 100, noise_db=36, bias_db=31, seconds=2)
    after = measured("demo_64", "after", 100, noise_db=43, bias_db=35, seconds=2.5)
    after = replace(after, cpu_s=2)
    thin = measured("bars", "before", 256, noise_db=40, bias_db=38, seconds=1)
    thicker = measured("bars", "after", 256, noise_db=40, bias_db=41.5, seconds=1)

    assert [(goal.got, goal.holds) for goal in judge([before, after])] == [
        (43, True),
        (35, False),
        (1.25, False),
        (1, True),
    ]
    assert [goal.got for goal in judge([after])] == [43, 35]
    assert [(goal.got, goal.holds) for goal in judge([thin, thicker])] == [(3.5, True)]
    assert judge([thicker, replace(before, width=960), replace(after, width=960)]) == []
    assert judge([replace(after, noise=NOTHING, bias=NOTHING)]) == []


def test_a_digest_changes_with_the_code(tmp_path: Path) -> None:
    (tmp_path / "render" / "trace").mkdir(parents=True)
    source = tmp_path / "render" / "trace" / "lens.py"
    source.write_text("1")
    first = code_digest(tmp_path)
    assert code_digest(tmp_path) == first
    source.write_text("2")
    assert code_digest(tmp_path) != first
