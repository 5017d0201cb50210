"""Light and shadow linking: UsdLux's collections say which surfaces a light leaves out."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdLux

from render.model.scene import LightLinks, Scene
from render.stage import StageReader, find_not_honoured
from tests.render.kits.stages import add_mesh, codes, new_stage, read

MESHES = ("/set/wall", "/set/floor", "/cast/hero")


def linked_stage() -> Usd.Stage:
    stage = new_stage()
    for path in MESHES:
        add_mesh(stage, path)
    UsdLux.SphereLight.Define(stage, "/key")
    UsdLux.DomeLight.Define(stage, "/sky")
    return stage


def light_link(stage: Usd.Stage, path: str = "/key") -> Usd.CollectionAPI:
    return UsdLux.LightAPI(stage.GetPrimAtPath(path)).GetLightLinkCollectionAPI()


def shadow_link(stage: Usd.Stage, path: str = "/key") -> Usd.CollectionAPI:
    return UsdLux.LightAPI(stage.GetPrimAtPath(path)).GetShadowLinkCollectionAPI()


def links(scene: Scene) -> dict[str, LightLinks]:
    """Links by the paths of the prims of each batch's triangles."""
    return {scene.prim_paths[number]: batch.links for batch in scene.batches for number in set(batch.geometry.prim_ids)}


def unlit(scene: Scene) -> dict[str, set[str]]:
    return {path: set(link.unlit_by) for path, link in links(scene).items() if link.unlit_by}


def test_without_links_surfaces_are_joined_as_ever() -> None:
    stage = linked_stage()
    assert len(read(stage).batches) == 1
    light_link(stage).GetIncludesRel().AddTarget("/cast")  # adds nothing to the root, which is included
    assert len(read(stage).batches) == 1
    assert unlit(read(stage)) == {}


def test_a_light_leaves_out_what_it_excludes() -> None:
    stage = linked_stage()
    light_link(stage).GetExcludesRel().AddTarget("/cast")
    light_link(stage, "/sky").GetExcludesRel().AddTarget("/set/floor")
    shadow_link(stage).GetExcludesRel().AddTarget("/set/wall")
    reader = StageReader(stage)
    scene = reader.read(0)
    assert unlit(scene) == {"/cast/hero": {"/key"}, "/set/floor": {"/sky"}}
    assert links(scene)["/set/wall"] == LightLinks(unshadowed=frozenset({"/key"}))
    assert reader.findings == find_not_honoured(stage) == []


def test_a_light_without_the_root_shines_on_what_it_names() -> None:
    stage = linked_stage()
    light_link(stage).GetIncludeRootAttr().Set(False)
    light_link(stage).GetIncludesRel().AddTarget("/set")
    light_link(stage).GetExcludesRel().AddTarget("/set/floor")
    assert unlit(read(stage)) == {"/set/floor": {"/key"}, "/cast/hero": {"/key"}}


def test_a_path_expression_links_too() -> None:
    stage = linked_stage()
    light_link(stage).GetIncludeRootAttr().Set(False)
    light_link(stage).GetMembershipExpressionAttr().Set(Sdf.PathExpression("/set//*{isa:Mesh} - /set/floor"))
    assert unlit(read(stage)) == {"/set/floor": {"/key"}, "/cast/hero": {"/key"}}


def test_links_follow_instances() -> None:
    """Native instances by their own paths; those of a point instancer by the instancer's."""
    stage = new_stage()
    add_mesh(stage, "/proto/mesh")
    for path in ("/a", "/b"):
        prim = stage.DefinePrim(path, "Xform")
        prim.GetReferences().AddInternalReference("/proto")
        prim.SetInstanceable(True)
    instancer = UsdGeom.PointInstancer.Define(stage, "/crowd")
    add_mesh(stage, "/crowd/mesh")
    instancer.CreatePrototypesRel().AddTarget("/crowd/mesh")
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (2, 0, 0)])
    UsdLux.SphereLight.Define(stage, "/key")
    light_link(stage).GetExcludesRel().SetTargets(["/b", "/crowd"])
    assert unlit(read(stage)) == {"/b/mesh": {"/key"}, "/crowd/mesh": {"/key"}}


def test_more_sets_than_are_linked_are_a_finding(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("render.stage.light_links.MAX_LINK_SETS", 2)
    stage = linked_stage()
    light_link(stage).GetExcludesRel().AddTarget("/cast")
    light_link(stage, "/sky").GetExcludesRel().AddTarget("/set/floor")
    reader = StageReader(stage)
    assert len(unlit(reader.read(0))) == 1
    assert codes(reader) == {"too_many_links"}


def cut_board(stage: Usd.Stage, path: str = "/board") -> None:
    """A board of four faces, in a row."""
    x, y = np.meshgrid(np.arange(5), np.arange(2))
    mesh = UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr([(float(a), float(b), 0.0) for a, b in zip(x.flat, y.flat, strict=True)])
    mesh.CreateFaceVertexCountsAttr([4] * 4)
    mesh.CreateFaceVertexIndicesAttr([corner for i in range(4) for corner in (i, i + 1, i + 6, i + 5)])
    mesh.CreateSubdivisionSchemeAttr("none")


def face_links(scene: Scene) -> dict[int, LightLinks]:
    """Links of each face that is drawn, once."""
    found = [(int(face), batch.links) for batch in scene.batches for face in set(batch.geometry.face_ids)]
    assert len(found) == len(dict(found))
    return dict(found)


KEYLESS, SKYLESS = LightLinks(frozenset({"/key"})), LightLinks(frozenset({"/sky"}))


def board_stage() -> Usd.Stage:
    """A board beside a lamp and a sky."""
    stage = new_stage()
    UsdLux.SphereLight.Define(stage, "/key")
    UsdLux.DomeLight.Define(stage, "/sky")
    cut_board(stage)
    return stage


def cut(stage: Usd.Stage, name: str, faces: list[int], family: str = "", path: str = "/board") -> Sdf.Path:
    mesh = UsdGeom.Mesh.Get(stage, path)
    return UsdGeom.Subset.CreateGeomSubset(mesh, name, UsdGeom.Tokens.face, faces, family).GetPath()


def test_a_light_leaves_out_faces() -> None:
    """Whatever the family and the materials; beside subsets that nobody names."""
    stage = board_stage()
    cut(stage, "steel", [2, 3], "materialBind")
    light_link(stage).GetExcludesRel().AddTarget(cut(stage, "left", [0, 2]))
    reader = StageReader(stage)
    assert face_links(reader.read(0)) == {0: KEYLESS, 1: LightLinks(), 2: KEYLESS, 3: LightLinks()}
    assert codes(reader) == set()


def test_a_light_shines_on_faces_alone() -> None:
    stage = board_stage()
    light_link(stage).GetIncludeRootAttr().Set(False)
    light_link(stage).GetIncludesRel().AddTarget(cut(stage, "left", [0, 1], "materialBind"))
    assert face_links(read(stage)) == {0: LightLinks(), 1: LightLinks(), 2: KEYLESS, 3: KEYLESS}
    light_link(stage).GetIncludesRel().ClearTargets(True)
    light_link(stage).GetMembershipExpressionAttr().Set(Sdf.PathExpression("//left"))
    assert face_links(read(stage)) == {0: LightLinks(), 1: LightLinks(), 2: KEYLESS, 3: KEYLESS}


def test_a_face_may_be_in_sets_of_several_lights() -> None:
    stage = board_stage()
    light_link(stage).GetExcludesRel().AddTarget(cut(stage, "a", [0, 1]))
    light_link(stage, "/sky").GetExcludesRel().AddTarget(cut(stage, "b", [1, 2]))
    shadow_link(stage).GetExcludesRel().AddTarget(cut(stage, "c", [3]))
    both, unshadowed = LightLinks(frozenset({"/key", "/sky"})), LightLinks(unshadowed=frozenset({"/key"}))
    assert face_links(read(stage)) == {0: KEYLESS, 1: both, 2: SKYLESS, 3: unshadowed}


def test_linked_faces_may_change() -> None:
    stage = board_stage()
    path = cut(stage, "a", [])
    indices = UsdGeom.Subset(stage.GetPrimAtPath(path)).GetIndicesAttr()
    for time, faces in ((1, [0]), (2, [1, 2, 9])):
        indices.Set(faces, time)
    light_link(stage).GetExcludesRel().AddTarget(path)
    reader = StageReader(stage)
    unlit_at = {
        time: {face for face, own in face_links(reader.read(time)).items() if own == KEYLESS} for time in (1, 2)
    }
    assert unlit_at == {1: {0}, 2: {1, 2}}
    assert codes(reader) == {"bad_subset"}


def test_instances_may_be_cut_in_unlike_ways() -> None:
    stage = new_stage()
    cut_board(stage, "/proto/mesh")
    for name, face in (("first", 0), ("last", 3)):
        cut(stage, name, [face], path="/proto/mesh")
    for path in ("/a", "/b"):
        prim = stage.DefinePrim(path, "Xform")
        prim.GetReferences().AddInternalReference("/proto")
        prim.SetInstanceable(True)
    UsdLux.SphereLight.Define(stage, "/key")
    light_link(stage).GetExcludesRel().SetTargets(["/a/mesh/first", "/b/mesh/last"])
    scene = read(stage)
    unlit_faces = {
        (scene.prim_paths[prim], int(face))
        for batch in scene.batches
        for prim, face in zip(batch.geometry.prim_ids, batch.geometry.face_ids, strict=True)
        if batch.links == KEYLESS
    }
    assert unlit_faces == {("/a/mesh", 0), ("/b/mesh", 3)}


def test_faces_that_cannot_be_linked_are_a_finding() -> None:
    """Points, and faces of what a point instancer repeats."""
    stage = board_stage()
    points = UsdGeom.Subset.CreateGeomSubset(
        UsdGeom.Mesh.Get(stage, "/board"), "corners", UsdGeom.Tokens.point, [0]
    ).GetPath()
    instancer = UsdGeom.PointInstancer.Define(stage, "/crowd")
    cut_board(stage, "/crowd/mesh")
    faces = cut(stage, "half", [0, 1], path="/crowd/mesh")
    instancer.CreatePrototypesRel().AddTarget("/crowd/mesh")
    instancer.CreateProtoIndicesAttr([0, 0])
    instancer.CreatePositionsAttr([(0, 0, 0), (2, 0, 0)])
    shadow_link(stage).GetExcludesRel().AddTarget(points)
    light_link(stage, "/sky").GetExcludesRel().AddTarget(faces)
    reader = StageReader(stage)
    assert {batch.links for batch in reader.read(0).batches} == {LightLinks()}
    assert codes(reader) == {"linked_subset"}
    assert {finding.path for finding in reader.findings} == {"/key", "/sky"}


def test_faces_of_more_subsets_than_a_word_has_bits() -> None:
    """Each face in subsets of its own of 70 lights, and in all of those before."""
    stage = board_stage()
    cut(stage, "other", [3])
    for number in range(70):
        UsdLux.SphereLight.Define(stage, f"/lamp_{number}")
        path = cut(stage, f"cut_{number}", [number % 2] if number < 69 else [0, 0, 2])
        light_link(stage, f"/lamp_{number}").GetExcludesRel().AddTarget(path)
    even, odd = (frozenset(f"/lamp_{number}" for number in range(first, 69, 2)) for first in (0, 1))
    last = frozenset({"/lamp_69"})
    assert face_links(read(stage)) == {
        0: LightLinks(even | last),
        1: LightLinks(odd),
        2: LightLinks(last),
        3: LightLinks(),
    }


def test_more_unlike_subsets_than_are_linked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Those that the same lights leave out count as one."""
    monkeypatch.setattr("render.stage.light_links.MAX_SUBSETS", 1)
    stage = board_stage()
    light_link(stage).GetExcludesRel().SetTargets([cut(stage, f"a{face}", [face]) for face in (0, 1)])
    reader = StageReader(stage)
    assert face_links(reader.read(0)) == {0: KEYLESS, 1: KEYLESS, 2: LightLinks(), 3: LightLinks()}
    assert codes(reader) == set()
    light_link(stage, "/sky").GetExcludesRel().AddTarget(cut(stage, "b", [3]))
    reader = StageReader(stage)
    assert face_links(reader.read(0)) == {0: KEYLESS, 1: KEYLESS, 2: LightLinks(), 3: LightLinks()}
    assert codes(reader) == {"too_many_links"}


def test_subsets_that_overlap_in_too_many_ways(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("render.stage.assembly.linked_faces.MAX_PATTERNS", 3)
    stage = board_stage()
    light_link(stage).GetExcludesRel().AddTarget(cut(stage, "a", [0, 1]))
    light_link(stage, "/sky").GetExcludesRel().AddTarget(cut(stage, "b", [1, 2]))
    reader = StageReader(stage)
    assert set(face_links(reader.read(0)).values()) == {LightLinks()}
    assert codes(reader) == {"bad_subset"}


@pytest.mark.parametrize(
    ("expression", "unlit_faces"),
    [
        ("/board// - /board/a", {0}),
        ("/board//{isa:Mesh} - /board/a", {0}),
        ("/board// - /board//a?", {1, 2}),
        ("/board// - /board//*", set()),  # leaves all subsets out, as it would if it spoke of meshes alone
        ("/board//{isa:Mesh}", set()),
        ("/board", set()),
        ("//", set()),
        ("/board/a /board/a1", {2, 3}),
    ],
)
def test_an_expression_may_leave_subsets_out(expression: str, unlit_faces: set[int]) -> None:
    stage = board_stage()
    for face, name in enumerate(("a", "a1", "a2")):
        cut(stage, name, [face])
    light_link(stage).GetIncludeRootAttr().Set(False)
    light_link(stage).GetMembershipExpressionAttr().Set(Sdf.PathExpression(expression))
    reader = StageReader(stage)
    found = face_links(reader.read(0))
    assert {face for face, own in found.items() if own == KEYLESS} == unlit_faces
    assert codes(reader) == set()
