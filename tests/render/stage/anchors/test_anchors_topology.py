"""A focus point knows the faces it was placed on: a re-export that keeps them keeps it, one that does not is told."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, Vt

from render.shot import Shot
from tests.render.kits.stages import add_mesh, dense_grid, new_stage
from usd_schemas import FocusPoint, LensCamera
from usd_schemas.topology import topology_change, topology_fingerprint, topology_under

N = 8


def export(path: Path, *, bend: float = 0.0, faces: int = N, kind: str = "mesh") -> None:
    """A character's layer, as its department writes it: the body may be bent anew, cut anew, or be something else."""
    stage = new_stage()
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(24)
    body = dense_grid(stage, "/body", faces)
    points = np.array(body.GetPointsAttr().Get())
    points[:, 2] = bend * points[:, 0] ** 2
    body.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(points))
    if kind != "mesh":
        stage.RemovePrim("/body")
        stage.DefinePrim("/body", kind)
    stage.Export(str(path))


def shot_of(folder: Path) -> Path:
    """A shot that sublayers the character and has a camera; nothing of it changes when the character is written again."""
    stage = Usd.Stage.CreateNew(str(folder / "shot.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    stage.GetRootLayer().subLayerPaths.append("character.usda")
    UsdGeom.Camera.Define(stage, "/cam").AddTranslateOp().Set((0.5, 0.5, 10))
    stage.Save()
    return folder / "shot.usda"


def placed(folder: Path) -> Path:
    """The edits of somebody who clicked on the body."""
    export(folder / "character.usda")
    shot = Shot.open(shot_of(folder))
    point = FocusPoint("hero", ("/body",), face=20, fan_triangle=1, barycentric=(0.2, 0.3, 0.5))
    assert shot.focus.add_point("/cam", "hero", point).topology
    shot.edits.save(folder / "edits.usda")
    return folder / "edits.usda"


def topology_findings(shot: Shot) -> list[str]:
    return [finding.message for finding in shot.findings() if finding.code == "topology_changed"]


def test_a_reexport_with_the_same_faces_keeps_the_point_in_place(tmp_path: Path) -> None:
    edits = placed(tmp_path)
    before = Shot.open(tmp_path / "shot.usda", edits=edits)
    place = before.focus.points("/cam", 1)[0].position_m
    assert place is not None
    del before
    assert Sdf.Layer.Find(str(tmp_path / "character.usda")) is None, "who lets go of a shot lets go of its files"
    export(tmp_path / "character.usda", bend=0.5)
    shot = Shot.open(tmp_path / "shot.usda", edits=edits)
    found = shot.focus.points("/cam", 1)[0].position_m
    assert found is not None
    np.testing.assert_allclose(found[:2], place[:2], atol=1e-6)
    # the bend is 0.5·x² at the grid's corners and straight between them
    assert found[2] == pytest.approx(0.5 * found[0] ** 2, abs=0.5 / N**2)
    assert found[2] > 0.01
    assert topology_findings(shot) == []


@pytest.mark.parametrize(("change", "says"), [({"faces": N + 1}, "look whether"), ({"kind": "Xform"}, "no mesh")])
def test_a_reexport_with_other_faces_is_a_finding_and_keeps_focus(tmp_path: Path, change: dict, says: str) -> None:
    edits = placed(tmp_path)
    export(tmp_path / "character.usda", **change)
    shot = Shot.open(tmp_path / "shot.usda", edits=edits)
    assert shot.focus.points("/cam", 1)[0].problem == ""
    assert shot.focus.read("/cam", 1).focus_distance_m == pytest.approx(10)
    (message,) = topology_findings(shot)
    assert "hero was placed on /body" in message
    assert says in message


def test_placing_the_point_again_settles_it(tmp_path: Path) -> None:
    edits = placed(tmp_path)
    export(tmp_path / "character.usda", faces=N + 1)
    shot = Shot.open(tmp_path / "shot.usda", edits=edits)
    assert len(topology_findings(shot)) == 1
    shot.focus.update_point("/cam", "hero", weight=2.0)
    assert len(topology_findings(shot)) == 1
    shot.focus.update_point("/cam", "hero", face=21)
    assert topology_findings(shot) == []


def test_a_face_that_is_gone_leaves_the_rest_of_the_shot(tmp_path: Path) -> None:
    edits = placed(tmp_path)
    export(tmp_path / "character.usda", faces=2)
    shot = Shot.open(tmp_path / "shot.usda", edits=edits)
    shot.focus.add_point("/cam", "left", FocusPoint("left", ("/body",), face=1, barycentric=(1.0, 0.0, 0.0)))
    hero, left = shot.focus.points("/cam", 1)
    assert "face 20" in hero.problem
    assert left.position_m == (0.5, 0, 0)
    assert {"lost_focus_point", "topology_changed"} <= {finding.code for finding in shot.findings()}
    assert shot.focus.read("/cam", 1).source == "points"
    assert shot.scene_at(1).triangle_count == 8


def test_what_the_fingerprint_is_of() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    taken = topology_fingerprint(mesh)
    mesh.GetPointsAttr().Set([(5, 5, 5)] * 4)
    assert topology_fingerprint(mesh) == taken
    mesh.GetFaceVertexIndicesAttr().Set([1, 2, 3, 0])
    assert topology_fingerprint(mesh) != taken
    triangles = add_mesh(stage, "/t", counts=[3, 3], corners=[0, 1, 2, 0, 2, 3])
    assert topology_fingerprint(triangles) != topology_fingerprint(
        add_mesh(stage, "/u", counts=[3], corners=[0, 1, 2, 0, 2, 3])
    )


@pytest.mark.parametrize("target", [(), ("/gone",), ("no path",), ("/group",), ("/group/m",)])
def test_points_on_no_face_of_a_mesh_have_no_topology(target: tuple[str, ...]) -> None:
    stage = new_stage()
    add_mesh(stage, "/group/m")
    UsdGeom.Xform.Define(stage, "/group")
    face = -1 if target == ("/group/m",) else 0
    assert topology_under(stage, FocusPoint("p", target, face=face)) == ""
    assert topology_change(stage, FocusPoint("p", target, face=face)) is None


def test_an_instanced_mesh_has_its_prototypes_topology(tmp_path: Path) -> None:
    stage = Usd.Stage.CreateNew(str(tmp_path / "s.usda"))
    add_mesh(stage, "/dots/a")
    UsdGeom.PointInstancer.Define(stage, "/dots").CreatePrototypesRel().SetTargets(["/dots/a"])
    dots = UsdGeom.PointInstancer(stage.GetPrimAtPath("/dots"))
    dots.CreateProtoIndicesAttr([0])
    dots.CreatePositionsAttr([(0, 0, 0)])
    camera = UsdGeom.Camera.Define(stage, "/cam")
    camera.AddTranslateOp().Set((0.0, 0.0, 5.0))
    stage.Save()
    shot = Shot.open(tmp_path / "s.usda")
    point = FocusPoint("p", ("/dots", "/dots/a"), face=0, instance=0)
    mesh = UsdGeom.Mesh(shot.stage.GetPrimAtPath("/dots/a"))
    assert shot.focus.add_point("/cam", "p", point).topology == topology_fingerprint(mesh)
    assert LensCamera(shot.stage.GetPrimAtPath("/cam")).focus_point("p").read().topology == topology_fingerprint(mesh)
