"""Prims that no renderer can use as they are: each makes a finding, and the rest of the stage is drawn."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt

from render.stage import StageReader, find_not_honoured
from render.stage.camera.framing import framing_camera
from tests.render.kits.stages import T, add_material, add_mesh, add_textured_material, bind, instancer, new_stage, read

NAN, INF = math.nan, math.inf
Author = Callable[[Usd.Stage], object]


def _dots(stage: Usd.Stage) -> UsdGeom.PointInstancer:
    UsdGeom.Sphere.Define(stage, "/bad/ball")
    return instancer(stage, "/bad", ["/bad/ball"], [0, 0])


def _order(stage: Usd.Stage, *names: str) -> None:
    add_mesh(stage, "/bad").GetXformOpOrderAttr().Set(list(names))


def _operation_of_another_type(stage: Usd.Stage) -> None:
    _order(stage, "xformOp:translate")
    stage.GetPrimAtPath("/bad").CreateAttribute("xformOp:translate", T.String).Set("x")


def _group(stage: Usd.Stage, name: str) -> UsdGeom.Xform:
    add_mesh(stage, f"/bad/{name}")
    return UsdGeom.Xform(UsdGeom.Xform.Define(stage, "/bad"))


def _subset(stage: Usd.Stage, indices: list[int]) -> None:
    faces = UsdGeom.Subset.CreateGeomSubset(add_mesh(stage, "/bad"), "part", "face", Vt.IntArray(indices))
    faces.CreateFamilyNameAttr("materialBind")


def _shaded(stage: Usd.Stage, name: str, kind: Sdf.ValueTypeName, value: object) -> None:
    add_material(stage, "/look").CreateInput(name, kind).Set(value)
    bind(add_mesh(stage, "/bad").GetPrim(), "/look")


def _material_that_is_not_there(stage: Usd.Stage) -> None:
    bound = UsdShade.MaterialBindingAPI.Apply(add_mesh(stage, "/bad").GetPrim()).GetPrim()
    bound.CreateRelationship("material:binding").SetTargets(["/nowhere"])


def _texture_coordinates_of_their_own(stage: Usd.Stage) -> None:
    texture = add_textured_material(stage, add_mesh(stage, "/bad").GetPrim(), "")
    turn = UsdShade.Shader.Define(stage, "/look/turn")
    turn.CreateIdAttr("UsdTransform2d")
    turned = turn.CreateOutput("result", T.Float2)
    turn.CreateInput("in", T.Float2).ConnectToSource(turned)
    texture.CreateInput("st", T.Float2).ConnectToSource(turned)


def _skinned(stage: Usd.Stage, joints: list[int], weights: list[float]) -> None:
    UsdSkel.Root.Define(stage, "/bad")
    skeleton = UsdSkel.Skeleton.Define(stage, "/bad/skeleton")
    skeleton.CreateJointsAttr(["a"])
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1)])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1)])
    binding = UsdSkel.BindingAPI.Apply(add_mesh(stage, "/bad/mesh").GetPrim())
    binding.CreateSkeletonRel().SetTargets(["/bad/skeleton"])
    binding.CreateJointIndicesPrimvar(False, 1).Set(joints)
    binding.CreateJointWeightsPrimvar(False, 1).Set(weights)


NOT_DRAWN: dict[str, tuple[str, Author]] = {
    "a place that is no number": ("bad_transform", lambda s: add_mesh(s, "/bad").AddTranslateOp().Set((NAN, 0, 0))),
    "an infinite scale": ("bad_transform", lambda s: add_mesh(s, "/bad").AddScaleOp().Set((INF, 1, 1))),
    "a group without a place": ("bad_transform", lambda s: _group(s, "mesh").AddTranslateOp().Set((NAN, 0, 0))),
    "a group that leaves its place": (
        "bad_transform",
        lambda s: _group(s, "mesh").AddTranslateOp().Set((NAN, 0, 0), 0),
    ),
    "a point that is no number": (
        "bad_geometry",
        lambda s: add_mesh(s, "/bad", points=[(0, 0, 0), (1, 0, 0), (NAN, 1, 0), (0, 1, 0)]),
    ),
    "a corner of no point": ("bad_geometry", lambda s: add_mesh(s, "/bad", corners=(0, 1, 2, 30))),
    "a negative count": ("bad_geometry", lambda s: add_mesh(s, "/bad", counts=(-4,))),
    "a huge count": ("bad_geometry", lambda s: add_mesh(s, "/bad", counts=(2**31 - 1,))),
    "huge counts that overflow": ("bad_geometry", lambda s: add_mesh(s, "/bad", counts=(2**31 - 1, 2**31 - 1, 6))),
    "more counts than corners": ("bad_geometry", lambda s: add_mesh(s, "/bad", counts=(4, 4))),
    "faces of two corners": ("no_faces", lambda s: add_mesh(s, "/bad", counts=(2, 2))),
    "a radius that is no number": ("bad_geometry", lambda s: UsdGeom.Sphere.Define(s, "/bad").CreateRadiusAttr(NAN)),
    "a purpose of no meaning": ("bad_purpose", lambda s: add_mesh(s, "/bad").CreatePurposeAttr("bogus")),
    "weights that are no numbers": ("bad_geometry", lambda s: _skinned(s, [0] * 4, [NAN, 1, 1, 1])),
    "an instancer of itself": ("instancers_too_deep", lambda s: instancer(s, "/bad", ["/bad"], [0])),
    "a light that is no number": ("bad_light", lambda s: UsdLux.SphereLight.Define(s, "/bad").CreateIntensityAttr(NAN)),
    "a light without a place": (
        "bad_light",
        lambda s: UsdLux.SphereLight.Define(s, "/bad").AddTranslateOp().Set((NAN, 0, 0)),
    ),
    "a dome without a direction": ("bad_light", lambda s: UsdLux.DomeLight.Define(s, "/bad").AddRotateXOp().Set(NAN)),
    "a type that nobody knows": ("unknown_schema", lambda s: s.DefinePrim("/bad", "StudioThing")),
}
"""Faults by which a prim is not drawn, with the code of the finding."""

DRAWN: dict[str, tuple[str, Author]] = {
    "an operation that is not there": ("bad_transform", lambda s: _order(s, "xformOp:other")),
    "an operation of no kind": ("bad_transform", lambda s: _order(s, "other")),
    "an operation of another type": ("bad_transform", _operation_of_another_type),
    "a hole in no face": ("bad_holes", lambda s: add_mesh(s, "/bad").CreateHoleIndicesAttr([7, -1])),
    "normals that are no numbers": (
        "bad_normals",
        lambda s: add_mesh(s, "/bad").CreateNormalsAttr([(NAN, 0, 0)] * 4),
    ),
    "too few normals": ("bad_normals", lambda s: add_mesh(s, "/bad").CreateNormalsAttr([(0, 0, 1)] * 3)),
    "a colour that is no number": (
        "bad_primvar_displayColor",
        lambda s: add_mesh(s, "/bad").CreateDisplayColorAttr([(NAN, 0, 0)]),
    ),
    "a subset of no face": ("bad_subset", lambda s: _subset(s, [0, 99, -5])),
    "a roughness that is no number": ("material_roughness", lambda s: _shaded(s, "roughness", T.Float, NAN)),
    "a shaded colour that is no number": (
        "material_diffuseColor",
        lambda s: _shaded(s, "diffuseColor", T.Color3f, (NAN, 0, 0)),
    ),
    "an opacity mode that is not there": ("material_opacityMode", lambda s: _shaded(s, "opacityMode", T.Token, "odd")),
    "texture coordinates of their own": ("material_st", _texture_coordinates_of_their_own),
    "a texture that is not there": (
        "texture_unreadable",
        lambda s: add_textured_material(s, add_mesh(s, "/bad").GetPrim(), "nowhere.png"),
    ),
    "a material that is not there": ("material_unread", _material_that_is_not_there),
    "a schema that nobody knows": (
        "unknown_schema",
        lambda s: add_mesh(s, "/bad").GetPrim().AddAppliedSchema("StudioAPI"),
    ),
    "a joint that is not there": ("skinning_failed", lambda s: _skinned(s, [0, 5, 0, -2], [1.0] * 4)),
    "an instance without a place": (
        "bad_transform",
        lambda s: _dots(s).CreatePositionsAttr([(NAN, 0, 0), (1, 0, 0)]),
    ),
    "an instance without a size": ("bad_transform", lambda s: _dots(s).CreateScalesAttr([(INF, 1, 1), (1, 1, 1)])),
    "an instance without a direction": (
        "bad_transform",
        lambda s: _dots(s).CreateOrientationsAttr([Gf.Quath(NAN, 0, 0, 0), Gf.Quath(1, 0, 0, 0)]),
    ),
    "an instance of no prototype": ("bad_proto_index", lambda s: _dots(s).CreateProtoIndicesAttr([0, 7])),
}
"""Faults with which a prim is still drawn, as far as it can be."""


@pytest.mark.parametrize("fault", [*NOT_DRAWN, *DRAWN])
def test_a_fault_is_named_and_the_rest_is_drawn(fault: str) -> None:
    code, author = (NOT_DRAWN | DRAWN)[fault]
    stage = new_stage()
    add_mesh(stage, "/good")
    author(stage)
    reader = StageReader(stage)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = reader.read(0.0)
    drawn = {scene.prim_paths[number] for batch in scene.batches for number in np.unique(batch.geometry.prim_ids)}
    assert "/good" in drawn
    assert any(path.startswith("/bad") for path in drawn) == (fault in DRAWN)
    assert code in {finding.code for finding in [*reader.findings, *find_not_honoured(stage)]}
    for batch in scene.batches:
        assert np.isfinite(batch.geometry.positions).all()
        assert np.isfinite(batch.poses).all()
    assert all(np.isfinite(light.radiance).all() for light in scene.lights)


def test_a_transform_that_is_not_finite_for_a_while_is_back_later() -> None:
    stage = new_stage()
    place = add_mesh(stage, "/m").AddTranslateOp()
    place.Set((NAN, 0, 0), 0)
    place.Set((1, 0, 0), 1)
    reader = StageReader(stage)
    assert [len(reader.read(time).batches) for time in (0, 1, 0)] == [0, 1, 0]


def test_the_other_instances_keep_their_numbers() -> None:
    stage = new_stage()
    _dots(stage).CreatePositionsAttr([(NAN, 0, 0), (1, 0, 0)])
    (batch,) = read(stage).batches
    assert batch.instance_numbers is not None
    assert batch.instance_numbers.tolist() == [1]


@pytest.mark.parametrize("place", [NAN, INF])
def test_a_stage_with_a_fault_is_framed_by_the_rest(place: float) -> None:
    stage = new_stage()
    add_mesh(stage, "/good")
    add_mesh(stage, "/bad").AddTranslateOp().Set((place, 0, 0))
    camera = framing_camera(stage, 0.0)
    assert camera.world_from_camera[:2, 3] == pytest.approx([0.5, 0.5])
