"""Variants and payloads of a shot, chosen in its edit layer."""

from __future__ import annotations

from pathlib import Path

import pytest

from render.errors import NotFoundError, SettingsError, StageError
from render.shot import Shot
from render.stage import choices

STAGE = """#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
)
def Camera "camera"
{
    double3 xformOp:translate = (0, 0, 10)
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
def Xform "World"
{
    def Xform "toy" (
        variants = { string shape = "ball" }
        prepend variantSets = ["shape"]
    )
    {
        variantSet "shape" = {
            "ball" {
                def Sphere "it" {
                }
            }
            "box" (
                prepend references = @other.usda@</box>
            ) {
            }
            "lost" (
                prepend references = @lost.usda@
            ) {
            }
        }
    }
    def "tram" (
        payload = @other.usda@</box>
    ) {
    }
    def "twin" (
        instanceable = true
        prepend references = </World/toy>
    ) {
    }
}
"""
OTHER = """#usda 1.0
def Xform "box"
{
    def Cube "it" {
    }
}
"""


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    (tmp_path / "shot.usda").write_text(STAGE)
    (tmp_path / "other.usda").write_text(OTHER)
    return Shot.open(tmp_path / "shot.usda", confined_to=tmp_path)


def drawn(shot: Shot) -> list[str]:
    scene = shot.scene_at(1.0)
    paths = {scene.prim_paths[prim] for batch in scene.batches for prim in batch.geometry.prim_ids}
    return sorted(path for path in paths if "twin" not in path)


def test_variants_and_payloads_are_listed(shot: Shot) -> None:
    found = {choice.prim: choice for choice in shot.choices.read().variants}
    assert set(found) == {"/World/toy", "/World/twin"}
    toy = found["/World/toy"]
    assert (toy.name, toy.variants, toy.selection, toy.is_edited) == ("shape", ("ball", "box", "lost"), "ball", False)
    assert [(choice.prim, choice.is_shown, choice.is_edited) for choice in shot.choices.read().payloads] == [
        ("/World/tram", True, False)
    ]


@pytest.mark.parametrize(
    ("bound", "most", "sets"), [("MOST_VARIANTS", 5, 1), ("MOST_CHOICES", 1, 1), ("MOST_VARIANTS", 6, 2)]
)
def test_lists_are_bounded_and_say_so(
    shot: Shot, monkeypatch: pytest.MonkeyPatch, bound: str, most: int, sets: int
) -> None:
    monkeypatch.setattr(choices, bound, most)
    found = shot.choices.read()
    assert (len(found.variants), found.is_whole) == (sets, sets == 2)


def test_a_variant_is_drawn_undone_and_taken_back(shot: Shot) -> None:
    assert drawn(shot) == ["/World/toy/it", "/World/tram/it"]
    ball = len(shot.scene_at(1.0).batches[0].geometry.triangles)
    shot.choices.choose_variant("/World/toy", "shape", "box")
    box = len(shot.scene_at(1.0).batches[0].geometry.triangles)
    assert box < ball
    toy = shot.choices.read().variants[0]
    assert (toy.selection, toy.is_edited) == ("box", True)
    shot.edits.undo()
    assert shot.choices.read().variants[0].selection == "ball"
    shot.edits.redo()
    shot.choices.choose_variant("/World/toy", "shape", None)
    toy = shot.choices.read().variants[0]
    assert (toy.selection, toy.is_edited) == ("ball", False)
    shot.choices.choose_variant("/World/toy", "shape", "")
    assert drawn(shot) == ["/World/tram/it"]


def test_a_payload_is_left_out_and_shown_again(shot: Shot) -> None:
    shot.choices.show_payload("/World/tram", False)
    assert drawn(shot) == ["/World/toy/it"]
    assert [(choice.is_shown, choice.is_edited) for choice in shot.choices.read().payloads] == [(False, True)]
    shot.choices.show_payload("/World/tram", None)
    assert drawn(shot) == ["/World/toy/it", "/World/tram/it"]


def test_files_that_a_variant_lacks_are_found(shot: Shot) -> None:
    shot.scene_at(1.0)
    shot.choices.choose_variant("/World/toy", "shape", "lost")
    shot.scene_at(1.0)
    assert "missing_reference" in {finding.code for finding in shot.findings()}


@pytest.mark.parametrize(
    ("prim", "name", "variant", "message"),
    [
        ("/World/none", "shape", "box", "no prim /World/none"),
        ("/World/toy", "shap", "box", "did you mean 'shape'"),
        ("/World/toy", "shape", "bocs", "did you mean 'box'"),
        ("/World/toy/it", "shape", "box", "there are none"),
        ("/World/twin/it", "shape", "box", "lies in an instance"),
        ("not a path", "shape", "box", "no prim"),
    ],
)
def test_choices_that_are_not_there_are_refused(shot: Shot, prim: str, name: str, variant: str, message: str) -> None:
    before = shot.edits.state()
    with pytest.raises((NotFoundError, SettingsError), match=message):
        shot.choices.choose_variant(prim, name, variant)
    assert shot.edits.state() == before


def test_only_prims_with_payloads_are_left_out(shot: Shot) -> None:
    with pytest.raises(SettingsError, match="/World/toy has no payload"):
        shot.choices.show_payload("/World/toy", False)


def test_a_variant_cannot_reach_outside_of_a_confined_shot(tmp_path: Path) -> None:
    inside = tmp_path / "in"
    inside.mkdir()
    (inside / "shot.usda").write_text(STAGE.replace("@lost.usda@", "@../outside.usda@</box>"))
    (inside / "other.usda").write_text(OTHER)
    (tmp_path / "outside.usda").write_text(OTHER)
    with pytest.raises(StageError, match="outside"):
        Shot.open(inside / "shot.usda", confined_to=inside)
