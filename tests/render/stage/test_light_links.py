"""Light and shadow linking: UsdLux's collections say which surfaces a light leaves out."""

from __future__ import annotations

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


def test_faces_in_a_link_are_a_finding() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/board")
    subset = UsdGeom.Subset.CreateGeomSubset(mesh, "half", UsdGeom.Tokens.face, [0])
    light = UsdLux.LightAPI(UsdLux.SphereLight.Define(stage, "/l").GetPrim())
    light.GetShadowLinkCollectionAPI().CreateExcludesRel().AddTarget(subset.GetPath())
    reader = StageReader(stage)
    reader.read(0)
    assert codes(reader) == {"linked_subset"}
    assert [finding.path for finding in reader.findings] == ["/l"]
