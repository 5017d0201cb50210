"""Validators: each names what is wrong, fixes what can be fixed without loss, and is silent where all is well."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from pxr import Sdf, Usd, UsdGeom, UsdValidation, Vt

from usd_schemas import (
    ApertureData,
    Asset,
    CharacteristicCurve,
    Configurations,
    DataSheet,
    FilmData,
    FocusData,
    FocusPoint,
    LensCamera,
    LensData,
    Prescription,
    define_camera,
)
from usd_schemas.topology import topology_fingerprint
from usd_schemas.validation import RULES, Problem, fix, validate

SINGLET = Prescription(radius=(50.0, -50.0), thickness=(4.0, 0.0), index=(1.5, 1.0), stop_surface=0, focus_group=(0, 1))


@pytest.fixture
def stage() -> Usd.Stage:
    """A shot in which all is well: a camera, a quad, a pyramid's instances and a focus point on each."""
    stage = Usd.Stage.CreateInMemory()
    quad = UsdGeom.Mesh.Define(stage, "/quad")
    quad.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
    quad.CreateFaceVertexCountsAttr([4])
    quad.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    instancer = UsdGeom.PointInstancer.Define(stage, "/trees")
    leaf = UsdGeom.Mesh.Define(stage, "/trees/leaf")
    leaf.CreateFaceVertexCountsAttr([3])
    leaf.CreateFaceVertexIndicesAttr([0, 1, 2])
    instancer.CreateProtoIndicesAttr([0, 0, 0])
    instancer.CreatePrototypesRel().SetTargets(["/trees/leaf"])
    camera = define_camera(stage, "/cam")
    camera.focus.author(FocusData(mode="points"))
    camera.lens.author(LensData(model="prescription", prescription=SINGLET))
    hero = FocusPoint("hero", ("/quad",), face=0, fan_triangle=1, topology=topology_fingerprint(quad))
    camera.add_focus_point("hero", hero)
    camera.add_focus_point("leaf", FocusPoint("leaf", ("/trees", "/trees/leaf"), face=0, instance=2))
    return stage


def the_problem(stage: Usd.Stage) -> Problem:
    problems = validate(stage)
    assert len(problems) == 1, problems
    return problems[0]


def camera_of(stage: Usd.Stage) -> LensCamera:
    return LensCamera(stage.GetPrimAtPath("/cam"))


def test_a_good_shot_has_no_problems(stage: Usd.Stage) -> None:
    assert validate(stage) == []


def test_every_rule_is_known_to_usd_with_its_words() -> None:
    registry = UsdValidation.ValidationRegistry()
    for rule in RULES:
        assert registry.GetValidatorMetadata(f"pullfocus:{rule.name}").doc == rule.doc != ""


def put(name: str, value: object) -> Callable[[Usd.Stage], None]:
    """Author a raw value on the camera, past all checks."""
    return lambda stage: stage.GetPrimAtPath("/cam").GetAttribute(name).Set(value)


def lens(**changes: object) -> Callable[[Usd.Stage], None]:
    return lambda stage: camera_of(stage).lens.author(replace(camera_of(stage).lens.read(), **changes))  # type: ignore[arg-type]


def singlet(**changes: object) -> Callable[[Usd.Stage], None]:
    return lens(prescription=replace(SINGLET, **changes))  # type: ignore[arg-type]


def zoom(**changes: object) -> Callable[[Usd.Stage], None]:
    positions = Configurations(thickness=(4.0, 48.0, 4.0, 49.0))
    return lens(configurations=replace(positions, **changes))  # type: ignore[arg-type]


def film(**changes: object) -> Callable[[Usd.Stage], None]:
    return lambda stage: camera_of(stage).film.author(FilmData(curve=CharacteristicCurve(**changes)))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("spoil", "rule", "message"),
    [
        (put("focalLength", -50.0), "CameraNumbers", "focalLength must be positive, got -50"),
        (put("horizontalAperture", float("nan")), "CameraNumbers", "horizontalAperture must be positive, got nan"),
        (put("fStop", -2.0), "CameraNumbers", "fStop must be 0 or more"),
        (put("clippingRange", (10, 1)), "CameraNumbers", "0 < near < far, got (10, 1)"),
        (put("shutter:close", -1.0), "CameraNumbers", "must not be before shutter:open"),
        (put("lens:transmittance", 1.5), "ValuesAllowed", "must be at most 1, got 1.5"),
        (put("lens:squeeze", float("inf")), "ValuesAllowed", "must be finite"),
        (put("lens:squeeze", 1e30), "ValuesAllowed", "lens:squeeze must be at most 10, got 1e+30"),
        (put("tiltShift:tilt", 91.0), "ValuesAllowed", "tiltShift:tilt must be at most 89, got 91"),
        (put("tiltShift:swing", -900.0), "ValuesAllowed", "tiltShift:swing must be at least -89, got -900"),
        (put("film:cdl:slope", (1, float("nan"), 1)), "ValuesAllowed", "must be finite"),
        (put("focus:mode", "psychic"), "ValuesAllowed", "must be one of manual, points"),
        (put("focusPoint:hero:weight", -1.0), "ValuesAllowed", "must be at least 0, got -1"),
        (singlet(index=(1.5,)), "Prescription", "lens:prescription:index must have 2 entries"),
        (singlet(index=(0.5, 1.0)), "Prescription", "entry 0 of lens:prescription:index must be at least 1"),
        (singlet(stop_surface=2), "Prescription", "one of the 2 surfaces (0 to 1), got 2"),
        (singlet(focus_group=(1, 0)), "Prescription", "0 <= first <= last < 2, got (1, 0)"),
        (lens(prescription=Prescription()), "Prescription", "needs at least one surface"),
        (
            lens(model="spherical", prescription=Prescription(radius=(1.0,), thickness=(1.0,))),
            "Prescription",
            "needs two surfaces, got 1",
        ),
        (
            zoom(thickness=(1.0, 2.0, 3.0)),
            "Configurations",
            "one entry for each of the 2 surfaces in each position, got 3",
        ),
        (zoom(thickness=(1.0, -2.0)), "Configurations", "entry 1 of lens:configuration:thickness must be at least 0"),
        (zoom(f_stop=(2.0,)), "Configurations", "lens:configuration:fStop must have 2 entries, one for each position"),
        (zoom(object_distance=(0.0, -1.0)), "Configurations", "entry 1 of lens:configuration:objectDistance"),
        (lens(model="dataSheet"), "DataSheet", "needs tables, got none"),
        (lens(data_sheet=DataSheet(height=(0.0, 10.0, 5.0))), "DataSheet", "must increase from 0"),
        (
            lens(data_sheet=DataSheet(height=(0.0, 10.0), coma=(0.1,))),
            "DataSheet",
            "lens:table:coma must have 2 entries",
        ),
        (
            lens(data_sheet=DataSheet(height=(0.0, 10.0), sagittal_blur=(0.01, -0.01))),
            "DataSheet",
            "entry 1 of lens:table:sagittalBlur must be at least 0, got -0.01",
        ),
        (put("aperture:blades", 2), "Iris", "must be 0 (round) or at least 3, got 2"),
        (put("aperture:radialWeights", Vt.DoubleArray([0.0, 0.0])), "Iris", "let light through somewhere"),
        (put("aperture:radialWeights", Vt.DoubleArray([1.0, -1.0])), "Iris", "entry 1 of aperture:radialWeights"),
        (film(red=((-1.0, 0.1), (-1.0, 0.5))), "FilmCurves", "must increase, got -1 after -1"),
        (film(green=((-1.0, 0.1), (0.0, 0.5), (1.0, 0.2))), "FilmCurves", "must rise or fall throughout"),
        (film(source="knots"), "FilmCurves", "needs at least 2 green knots, got 0"),
        (
            put("aperture:mask", Sdf.AssetPath("./no_such.png")),
            "AssetsResolve",
            "names ./no_such.png, which is not there",
        ),
        (put("focusPoint:hero:face", 7), "FocusPointAnchors", "/quad has 1 faces, got face 7"),
        (put("focusPoint:hero:fanTriangle", 2), "FocusPointAnchors", "has 2 triangles, got triangle 2"),
        (put("focusPoint:leaf:instance", 3), "FocusPointAnchors", "/trees has 3 instances, got 3"),
        (put("focusPoint:hero:instance", 0), "FocusPointAnchors", "no PointInstancer"),
        (put("focusPoint:hero:barycentric", (0.9, 0.9, 0.0)), "FocusPointBarycentrics", "sum to 1"),
        (put("focusPoint:hero:barycentric", (1.5, -0.5, 0.0)), "FocusPointBarycentrics", "0 or more"),
    ],
)
def test_what_is_wrong_is_named(stage: Usd.Stage, spoil: Callable[[Usd.Stage], None], rule: str, message: str) -> None:
    spoil(stage)
    problem = the_problem(stage)
    assert problem.rule == rule
    assert message in problem.message
    assert problem.path.startswith("/cam.")


def test_a_key_that_is_wrong_is_named_with_its_time(stage: Usd.Stage) -> None:
    camera_of(stage).set_key("focalLength", 10, 50.0)
    camera_of(stage).set_key("focalLength", 20, -50.0)
    assert "focalLength at time 20 must be positive" in the_problem(stage).message


def test_a_stop_beyond_the_lens_is_a_warning(stage: Usd.Stage) -> None:
    lens(f_stop_range=(2.8, 22.0))(stage)
    put("fStop", 1.4)(stage)
    problem = the_problem(stage)
    assert (problem.rule, problem.severity) == ("LensReach", "warning")
    assert "the lens opens from f/2.8 to f/22, got fStop of 1.4" in problem.message


def test_an_instance_is_named_by_its_id_where_there_are_ids(stage: Usd.Stage) -> None:
    ids = UsdGeom.PointInstancer(stage.GetPrimAtPath("/trees")).CreateIdsAttr([100, 2, 300])
    assert validate(stage) == []
    ids.Set([100, 200, 300])
    assert "/trees has no instance of id 2" in the_problem(stage).message
    ids.Set([200, 2, 300], 10)  # it may come later
    assert validate(stage) == []


def test_instances_in_instances_have_numbers_beyond_the_outer_count(stage: Usd.Stage) -> None:
    inner = UsdGeom.PointInstancer.Define(stage, "/trees/twigs")
    inner.CreateProtoIndicesAttr([0, 0])
    put("focusPoint:leaf:instance", 5)(stage)
    assert validate(stage) == []


@pytest.mark.parametrize(
    ("targets", "message"),
    [
        (["/gone"], "has the target /gone, which is not there"),
        ([], "needs one target"),
        (["/look"], "needs an Xformable as its target, got /look of Scope"),
    ],
)
def test_a_target_that_cannot_be_followed_is_named(stage: Usd.Stage, targets: list[str], message: str) -> None:
    stage.DefinePrim("/look", "Scope")
    camera_of(stage).focus_point("hero").target_relationship().SetTargets(targets)
    problem = the_problem(stage)
    assert problem.rule == "FocusPointTargets"
    assert message in problem.message


def follow(stage: Usd.Stage, *parts: str, place: tuple[float, float, float] = (0.5, 0.5, 0.5)) -> None:
    view = camera_of(stage).focus_point("hero")
    view.part_relationship().SetTargets(parts)
    stage.GetPrimAtPath("/cam").GetAttribute("focusPoint:hero:boundsPoint").Set(place)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (["/gone"], "focus point hero follows the bounds of /gone, which is not there"),
        (["/quad", "/trees"], "focus point hero follows the bounds of one part, got 2"),
    ],
)
def test_a_part_that_cannot_be_followed_is_named(stage: Usd.Stage, parts: list[str], message: str) -> None:
    follow(stage, *parts)
    problem = the_problem(stage)
    assert (problem.rule, problem.path, problem.severity) == (
        "FocusPointParts",
        "/cam.focusPoint:hero:part",
        "error",
    )
    assert message in problem.message


def test_a_part_that_is_deactivated_is_named(stage: Usd.Stage) -> None:
    UsdGeom.Xform.Define(stage, "/off").GetPrim().SetActive(False)
    follow(stage, "/off")
    assert "follows the bounds of /off, which is deactivated" in the_problem(stage).message


def test_a_place_far_out_of_bounds_is_noticed(stage: Usd.Stage) -> None:
    follow(stage, "/quad", place=(-0.5, 2.0, 0.5))
    assert validate(stage) == []
    follow(stage, "/quad", place=(0.5, 0.5, 2.5))
    problem = the_problem(stage)
    assert (problem.rule, problem.severity) == ("FocusPointPlaces", "warning")
    assert "from 0 to 1, or at most 1 outside, got (0.5, 0.5, 2.5)" in problem.message
    follow(stage, place=(0.5, 0.5, 2.5))
    assert validate(stage) == []


def test_of_a_point_that_follows_a_part_the_target_is_free(stage: Usd.Stage) -> None:
    put("focusPoint:hero:face", 12)(stage)
    UsdGeom.Mesh.Get(stage, "/quad").GetFaceVertexIndicesAttr().Set([3, 2, 1, 0])
    camera_of(stage).focus_point("hero").target_relationship().SetTargets(["/gone"])
    follow(stage, "/trees")
    assert validate(stage) == []


def test_a_re_export_with_other_faces_is_noticed(stage: Usd.Stage) -> None:
    mesh = UsdGeom.Mesh.Get(stage, "/quad")
    mesh.GetPointsAttr().Set([(5, 5, 5)] * 4)
    assert validate(stage) == [], "points may move"
    mesh.GetFaceVertexIndicesAttr().Set([3, 2, 1, 0])
    assert the_problem(stage).rule == "FocusPointTopology"


def test_focusing_by_points_without_any_is_noticed(stage: Usd.Stage) -> None:
    for name in ("hero", "leaf"):
        camera_of(stage).remove_focus_point(name)
    assert the_problem(stage).rule == "FocusMode"


# Fixes ----------------------------------------------------------------------------------------------------------------


def test_a_value_past_its_limit_is_clamped_in_the_edit_layer(stage: Usd.Stage) -> None:
    put("lens:transmittance", 1.5)(stage)
    below = stage.GetRootLayer().ExportToString()
    stage.SetEditTarget(stage.GetSessionLayer())
    assert the_problem(stage).fix
    assert fix(stage, the_problem(stage))
    assert validate(stage) == []
    assert camera_of(stage).lens.read().transmittance == 1.0
    assert stage.GetRootLayer().ExportToString() == below


def test_what_no_limit_says_is_not_guessed(stage: Usd.Stage) -> None:
    put("lens:squeeze", float("nan"))(stage)
    assert the_problem(stage).fix == ""
    assert not fix(stage, the_problem(stage))


def test_barycentric_coordinates_are_normalised(stage: Usd.Stage) -> None:
    put("focusPoint:hero:barycentric", (0.5, 1.0, 0.5))(stage)
    assert fix(stage, the_problem(stage))
    assert camera_of(stage).focus_point("hero").read().barycentric == (0.25, 0.5, 0.25)
    assert validate(stage) == []


def test_a_point_outside_its_triangle_is_not_moved(stage: Usd.Stage) -> None:
    put("focusPoint:hero:barycentric", (1.5, -0.5, 0.0))(stage)
    assert not fix(stage, the_problem(stage))


def test_a_hidden_spline_is_removed_and_the_picture_stays(stage: Usd.Stage) -> None:
    camera_of(stage).set_key("fStop", 1, 2.8)
    attribute = stage.GetAttributeAtPath("/cam.fStop")
    attribute.Set(5.0, 1)  # beside the spline, as an exporter might
    problem = the_problem(stage)
    assert problem.rule == "HiddenSplines"
    assert fix(stage, problem)
    assert attribute.Get(1) == 5.0
    assert validate(stage) == []


def test_schemas_on_what_is_no_camera_are_taken_off(stage: Usd.Stage) -> None:
    prim = stage.GetPrimAtPath("/quad")
    prim.ApplyAPI("LensAPI")  # ApplyAPI does not enforce apiSchemaCanOnlyApplyTo
    prim.ApplyAPI("FocusPointAPI", "a")
    problems = validate(stage)
    assert {problem.rule for problem in problems} == {"SchemasOnCameras"}
    assert len(problems) == 2
    assert fix(stage, problems[0])
    assert validate(stage) == []


def test_a_stage_with_a_lens_camera_says_what_others_may_take_it_for(stage: Usd.Stage) -> None:
    stage.DefinePrim("/lens_cam", "LensCamera")
    problem = the_problem(stage)
    assert (problem.rule, problem.severity, problem.path) == ("FallbackType", "warning", "/")
    stage.SetEditTarget(stage.GetSessionLayer())
    assert not fix(stage, problem), "only the root layer can say it"
    stage.SetEditTarget(stage.GetRootLayer())
    assert fix(stage, problem)
    assert validate(stage) == []


def test_usds_own_client_sees_and_fixes_the_same(tmp_path: object) -> None:
    """UsdValidation's context and fixers, which save what they fix, without our `validate` and `fix`."""
    stage = Usd.Stage.CreateNew(f"{tmp_path}/shot.usda")
    define_camera(stage, "/cam").aperture.author(ApertureData(roundness=0.5, mask=Asset()))
    put("aperture:roundness", 3.0)(stage)
    stage.Save()
    (error,) = UsdValidation.ValidationContext(keywords=["pullfocus"]).Validate(stage)
    assert error.GetIdentifier() == "pullfocus:ValuesAllowed.ValuesAllowed"
    (fixer,) = error.GetFixers()
    target = Usd.EditTarget(stage.GetRootLayer())
    assert fixer.CanApplyFix(error, target)
    assert fixer.ApplyFix(error, target)
    again = Usd.Stage.Open(Sdf.Layer.OpenAsAnonymous(stage.GetRootLayer().identifier))
    assert LensCamera(again.GetPrimAtPath("/cam")).aperture.read().roundness == 1.0
