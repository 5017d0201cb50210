"""The typed view: what is authored is what is read, at every time, and nothing else is touched."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from pxr import Sdf, Usd, UsdGeom

from usd_schemas import (
    ApertureData,
    Asset,
    FilmData,
    FocusData,
    FocusPoint,
    GradeData,
    LensCamera,
    LensData,
    Prescription,
    SchemaError,
    Seidel,
    TiltShiftData,
    define_camera,
    define_lens_camera,
)

HERO = FocusPoint("hero", ("/subject",), face=4, fan_triangle=1, barycentric=(0.2, 0.3, 0.5), weight=0.5)

EXAMPLES = {
    "lens": LensData(
        model="prescription",
        name="Singlet",
        squeeze=2.0,
        seidel=Seidel(w040=1.5),
        prescription=Prescription(
            radius=(50.0, -50.0),
            thickness=(4.0, 0.0),
            index=(1.5168, 1.0),
            sellmeier_b=((1.03961212, 0.231792344, 1.01046945), (0.0, 0.0, 0.0)),
            sellmeier_c=((0.00600069867, 0.0200179144, 103.560653), (0.0, 0.0, 0.0)),
            glass=("BK7", ""),
            stop_surface=0,
            focus_group=(0, 1),
        ),
    ),
    "aperture": ApertureData(
        blades=7, roundness=0.25, rotation=12.0, mask=Asset("./iris.png"), radial_weights=(1.0, 0.5)
    ),
    "tilt_shift": TiltShiftData(tilt_deg=-4.0, shift_mm=3.5, driven_by_points=False),
    "film": FilmData(stock="5219", push=1.0, grade=GradeData(view="Film", cdl_slope=(1.1, 1.0, 0.9))),
    "focus": FocusData(mode="surface", field_offsets=((0.5, 0.5, 0.1),), surface_exponent=2.5),
}


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    return LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())


@pytest.mark.parametrize("view", EXAMPLES)
def test_what_is_authored_is_read(camera: LensCamera, view: str) -> None:
    getattr(camera, view).author(EXAMPLES[view])
    assert getattr(camera, view).read() == EXAMPLES[view]


@pytest.mark.parametrize("view", EXAMPLES)
def test_a_camera_without_the_schema_says_its_fallbacks(camera: LensCamera, view: str) -> None:
    assert not getattr(camera, view).applied
    assert getattr(camera, view).read() == type(EXAMPLES[view])()
    assert camera.authored() == []


def test_a_lens_camera_has_the_schemas_built_in(stage: Usd.Stage) -> None:
    camera = define_lens_camera(stage, "/lens_cam")
    assert camera.lens.applied
    assert camera.focus.applied
    assert stage.GetRootLayer().pseudoRoot.GetInfo("fallbackPrimTypes") == {"LensCamera": ["Camera"]}


def test_define_camera_applies_the_schemas_to_a_plain_camera(stage: Usd.Stage) -> None:
    camera = define_camera(stage, "/cam")
    assert camera.prim.GetTypeName() == "Camera"
    assert camera.film.applied


def test_authoring_pins_nothing_but_what_changes(camera: LensCamera) -> None:
    camera.aperture.author(ApertureData(blades=5))
    assert camera.authored() == ["aperture:blades"]
    authored = [attribute.GetName() for attribute in camera.prim.GetAuthoredAttributes()]
    assert authored == ["aperture:blades"]


def test_a_number_authored_at_a_time_is_a_key_on_a_spline(camera: LensCamera) -> None:
    camera.tilt_shift.author(TiltShiftData(tilt_deg=0.0))
    camera.tilt_shift.author(TiltShiftData(tilt_deg=2.0), time=10)
    camera.tilt_shift.author(TiltShiftData(tilt_deg=6.0), time=20)
    assert camera.tilt_shift.read(15).tilt_deg == 4.0
    assert camera.prim.GetAttribute("tiltShift:tilt").HasSpline()
    assert [key.time for key in camera.keys("tiltShift:tilt")] == [10, 20]


def test_a_uniform_value_is_the_same_at_all_times(camera: LensCamera) -> None:
    camera.lens.author(LensData(model="seidel"), time=10)
    assert camera.lens.read(0).model == camera.lens.read(50).model == "seidel"


def test_a_value_that_keys_would_hide_is_refused(camera: LensCamera) -> None:
    camera.tilt_shift.author(TiltShiftData(tilt_deg=2.0), time=10)
    camera.tilt_shift.author(TiltShiftData(tilt_deg=3.0), time=20)
    with pytest.raises(SchemaError, match="tiltShift:tilt has keys"):
        camera.tilt_shift.author(TiltShiftData(tilt_deg=5.0, rise_mm=1.0))
    assert camera.tilt_shift.read(10) == TiltShiftData(tilt_deg=2.0), "nothing of it is authored"


def test_a_camera_is_needed(stage: Usd.Stage) -> None:
    xform = UsdGeom.Xform.Define(stage, "/x").GetPrim()
    with pytest.raises(SchemaError, match="got /x of type Xform"):
        LensCamera(xform)
    with pytest.raises(SchemaError, match="got an invalid prim"):
        LensCamera(stage.GetPrimAtPath("/nowhere"))


@pytest.mark.parametrize(
    ("view", "data", "message"),
    [
        ("lens", LensData(model="fishy"), "must be one of pinhole, thin"),  # type: ignore[arg-type]
        ("lens", LensData(transmittance=1.5), "must be at most 1, got 1.5"),
        ("lens", LensData(squeeze=float("nan")), "is of type double, got nan"),
        ("lens", LensData(prescription=Prescription(radius=(1.0, float("inf")))), r"is of type double\[\]"),
        ("lens", LensData(prescription=Prescription(radius="long")), r"is of type double\[\]"),  # type: ignore[arg-type]
        ("aperture", ApertureData(blades=-1), "must be at least 0, got -1"),
        ("aperture", ApertureData(blades=5.5), "is of type int, got 5.5"),  # type: ignore[arg-type]
        ("focus", FocusData(solve_stop="yes"), "is of type bool"),  # type: ignore[arg-type]
        ("film", FilmData(grade=GradeData(cdl_slope=(1.0, 1.0))), "is of type double3"),  # type: ignore[arg-type]
        ("film", FilmData(stock=5219), "is of type string, got 5219"),  # type: ignore[arg-type]
    ],
)
def test_values_that_are_not_allowed_are_refused_by_name(
    camera: LensCamera, view: str, data: Any, message: str
) -> None:
    with pytest.raises(SchemaError, match=message):
        getattr(camera, view).author(data)
    assert camera.authored() == []


# Focus points ---------------------------------------------------------------------------------------------------------


def test_a_focus_point_is_what_was_added(camera: LensCamera) -> None:
    view = camera.add_focus_point("hero", HERO)
    assert view.read() == HERO
    assert camera.focus_point("hero").read() == HERO
    assert [point.name for point in camera.focus_points()] == ["hero"]


def test_a_new_focus_point_authors_every_value_for_other_readers(camera: LensCamera) -> None:
    view = camera.add_focus_point("hero", FocusPoint("hero", ("/subject",)))
    assert all(attribute.HasAuthoredValue() for attribute in view.attributes())


def test_focus_points_keep_their_order_and_their_own_values(camera: LensCamera) -> None:
    for index, name in enumerate(("near", "far", "middle")):
        camera.add_focus_point(name, replace(HERO, name=name, face=index))
    assert [point.name for point in camera.focus_points()] == ["near", "far", "middle"]
    assert [point.read().face for point in camera.focus_points()] == [0, 1, 2]


def test_a_removed_focus_point_is_gone_and_can_come_back_clean(camera: LensCamera) -> None:
    camera.add_focus_point("hero", HERO).set_key("weight", 5, 0.75)
    camera.remove_focus_point("hero")
    assert camera.focus_points() == []
    assert camera.add_focus_point("hero", HERO).read(5) == HERO


def test_removing_in_an_edit_layer_leaves_the_file_alone(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.add_focus_point("hero", HERO).set_key("weight", 5, 0.75)
    before = stage.GetRootLayer().ExportToString()
    stage.SetEditTarget(stage.GetSessionLayer())
    camera.remove_focus_point("hero")
    assert camera.focus_points() == []
    assert camera.add_focus_point("hero", HERO).read(5) == HERO, "keys of the layer below do not come back"
    assert stage.GetRootLayer().ExportToString() == before


def test_an_instancer_target_has_two_paths(camera: LensCamera) -> None:
    point = FocusPoint("leaf", ("/trees", "/trees/Prototypes/leaf/mesh"), face=0, instance=17)
    assert camera.add_focus_point("leaf", point).read() == point


def test_a_focus_point_follows_a_part_or_its_target(stage: Usd.Stage, camera: LensCamera) -> None:
    view = camera.add_focus_point("hero", HERO)
    assert not view.part_relationship().HasAuthoredTargets()
    subject = replace(HERO, part="/World/Hero", bounds_point=(0.25, 0.5, 0.75))
    view.author(subject)
    assert view.read() == subject
    assert view.read_over([1, 2]) == (subject, subject)
    stage.SetEditTarget(stage.GetSessionLayer())
    view.author(HERO)
    assert view.read() == HERO
    camera.remove_focus_point("hero")
    assert camera.add_focus_point("hero", HERO).read() == HERO, "the part of the layer below does not come back"


def test_a_point_that_follows_a_part_needs_no_target(camera: LensCamera) -> None:
    subject = FocusPoint("hero", part="/World/Hero")
    assert camera.add_focus_point("hero", subject).read() == subject


def test_an_edit_of_a_focus_point_changes_what_it_says_alone(stage: Usd.Stage, camera: LensCamera) -> None:
    view = camera.add_focus_point("hero", HERO)
    stage.SetEditTarget(stage.GetSessionLayer())
    view.author(replace(HERO, weight=0.75, target=("/other",)))
    assert view.read() == replace(HERO, weight=0.75, target=("/other",))
    edited = stage.GetSessionLayer().GetPrimAtPath("/cam").properties
    assert sorted(prop.name for prop in edited) == ["focusPoint:hero:target", "focusPoint:hero:weight"]


@pytest.mark.parametrize("schemas_before", [False, True])
@pytest.mark.parametrize("in_edit_layer", [False, True])
def test_a_refused_edit_leaves_no_trace(
    stage: Usd.Stage, camera: LensCamera, schemas_before: bool, in_edit_layer: bool
) -> None:
    if in_edit_layer:
        stage.SetEditTarget(stage.GetSessionLayer())
    if schemas_before:
        camera.focus.author(FocusData(mode="points"))
    before = [layer.ExportToString() for layer in stage.GetLayerStack()]
    with pytest.raises(SchemaError, match="must be at least 0"):
        camera.add_focus_point("hero", replace(HERO, weight=-1.0))
    with pytest.raises(SchemaError, match="must be at most 1"):
        camera.lens.author(LensData(name="too clear", transmittance=2.0))
    assert [layer.ExportToString() for layer in stage.GetLayerStack()] == before


@pytest.mark.parametrize(
    ("act", "message"),
    [
        (lambda camera: camera.add_focus_point("9lives", HERO), "must be an identifier"),
        (
            lambda camera: camera.add_focus_point("x", replace(HERO, part="Hero")),
            "the part of focus point 'hero' must be an absolute prim path, got 'Hero'",
        ),
        (
            lambda camera: camera.add_focus_point("x", replace(HERO, part="/__Prototype_1")),
            "must be a prim of the scene, not of a prototype, got '/__Prototype_1'",
        ),
        (lambda camera: camera.add_focus_point("a:b", HERO), "must be an identifier"),
        (lambda camera: camera.add_focus_point("weight", HERO), "not an allowed instance name"),
        (lambda camera: camera.add_focus_point("hero", HERO), "already has a focus point named 'hero'"),
        (lambda camera: camera.focus_point("villain"), "it has: hero"),
        (lambda camera: camera.remove_focus_point("villain"), "no focus point named 'villain'"),
        (lambda camera: camera.add_focus_point("x", replace(HERO, target=())), "needs one target path"),
        (lambda camera: camera.add_focus_point("x", replace(HERO, target=("not a path",))), "absolute prim path"),
        (lambda camera: camera.add_focus_point("x", replace(HERO, target=("/a.b",))), "absolute prim path"),
        (lambda camera: camera.add_focus_point("x", replace(HERO, target=("a/b",))), "absolute prim path"),
        (lambda camera: camera.focus_point("hero").set_key("nearness", 1, 1.0), "got 'nearness'"),
        (lambda camera: camera.set_key("lens:nearness", 1, 1.0), "no attribute named 'lens:nearness'"),
    ],
)
def test_mistakes_with_focus_points_are_named(
    camera: LensCamera, act: Callable[[LensCamera], object], message: str
) -> None:
    camera.add_focus_point("hero", HERO)
    with pytest.raises(SchemaError, match=message):
        act(camera)


def test_a_referenced_camera_is_edited_through_the_reference(stage: Usd.Stage) -> None:
    asset = Usd.Stage.CreateInMemory()
    UsdGeom.Xform.Define(asset, "/rig/subject")
    camera = define_camera(asset, "/rig/cam")
    camera.add_focus_point("hero", replace(HERO, target=("/rig/subject",)))
    shot_rig = stage.DefinePrim("/shot/rig")
    shot_rig.GetReferences().AddReference(asset.GetRootLayer().identifier, Sdf.Path("/rig"))
    here = LensCamera(stage.GetPrimAtPath("/shot/rig/cam"))
    assert here.focus_point("hero").read().target == ("/shot/rig/subject",)
    here.focus_point("hero").author(replace(here.focus_point("hero").read(), weight=0.25))
    assert here.focus_point("hero").read().weight == 0.25
    assert camera.focus_point("hero").read().weight == 0.5
