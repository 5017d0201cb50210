"""Lists of findings are shortened where many are alike, and none is lost."""

from __future__ import annotations

import pytest
from pxr import UsdGeom

from render.stage import Finding
from render.stage.findings import condense
from render.stage.reader import StageReader
from tests.render.kits.stages import new_stage


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5, 200])
def test_findings_of_one_code_are_counted(count: int) -> None:
    many = [Finding("alike", f"/p{number}", f"/p{number} is bad") for number in range(count)]
    found = condense([Finding("first", "/a", "a"), *many, Finding("last", "/z", "z", 5)], 3)
    assert [finding.code for finding in found] == ["first", *["alike"] * min(count, 4), "last"]
    assert sum(finding.count for finding in found) == count + 6
    if count > 4:
        assert found[-2] == Finding("alike", "/p3", f"{count - 3:,} more findings like these: /p3 is bad", count - 3)


def test_a_thousand_curves_make_a_short_list() -> None:
    stage = new_stage()
    for number in range(1000):
        UsdGeom.BasisCurves.Define(stage, f"/c{number}")
    reader = StageReader(stage)
    reader.read(0)
    assert len(reader.findings) == 1000
    assert len(condense(reader.findings, 50)) == 51
