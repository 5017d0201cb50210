"""The library of bodies: legal, as published, findable, and mountable on any camera."""

from __future__ import annotations

import pytest
from pxr import Usd, UsdGeom

import usd_schemas
from usd_schemas import LensCamera, LensData, LibraryBody, SchemaError, library_body, mount_body, mount_lens
from usd_schemas.body_library import BODY_LIBRARY_FILE
from usd_schemas.validation import validate

BODIES = usd_schemas.library_bodies()
each_body = pytest.mark.parametrize("body", BODIES, ids=lambda body: body.name)


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    return LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())


def apertures(camera: LensCamera, time: float = 1) -> tuple[float, float]:
    return tuple(camera.prim.GetAttribute(name).Get(time) for name in ("horizontalAperture", "verticalAperture"))


def test_the_library_keeps_the_rules_of_the_schemas() -> None:
    assert validate(Usd.Stage.Open(str(BODY_LIBRARY_FILE))) == []


@each_body
def test_each_body_says_what_a_list_of_them_shows(body: LibraryBody) -> None:
    assert body.description.endswith(".")
    assert "\n" not in body.description
    assert body.title
    assert 4 < body.gate_mm[0] < 130
    assert body.gate_mm[1] <= body.gate_mm[0]
    assert library_body(body.title) == body
    assert (body.kind == "digital") == (body.resolution != (0, 0))


@each_body
def test_photosites_are_square(body: LibraryBody) -> None:
    """So that a slip in a number shows: makers tell sizes to a tenth of a millimetre at worst."""
    if body.kind == "digital":
        across, up = (side / count for side, count in zip(body.gate_mm, body.resolution, strict=True))
        assert across == pytest.approx(up, rel=0.012)
        assert 0.002 < across < 0.009


@pytest.mark.parametrize(
    ("name", "gate_mm", "shape"),
    [
        ("super35_4perf", (0.980 * 25.4, 0.735 * 25.4), 4 / 3),
        ("super35_3perf", (0.980 * 25.4, 0.546 * 25.4), 1.79),
        ("academy_35", (0.866 * 25.4, 0.630 * 25.4), 1.37),
        ("anamorphic_35", (0.866 * 25.4, 0.732 * 25.4), 2.37),
        ("techniscope", (0.868 * 25.4, 0.373 * 25.4), 2.33),
        ("super16", (0.493 * 25.4, 0.292 * 25.4), 1.69),
        ("standard16", (0.404 * 25.4, 0.295 * 25.4), 1.37),
        ("super8", (0.228 * 25.4, 0.158 * 25.4), 1.44),
        ("film_65", (2.066 * 25.4, 0.906 * 25.4), 2.28),
        ("ultra_panavision_70", (2.066 * 25.4, 0.906 * 25.4), 2.85),
        ("vistavision", (1.485 * 25.4, 0.981 * 25.4), 1.51),
        ("imax_65", (2.772 * 25.4, 2.072 * 25.4), 1.34),
    ],
)
def test_film_gates_are_what_the_standards_say_in_inches(name: str, gate_mm: tuple[float, float], shape: float) -> None:
    body = library_body(name)
    assert body.gate_mm == pytest.approx(gate_mm, abs=0.01)
    assert body.gate_mm[0] * body.squeeze / body.gate_mm[1] == pytest.approx(shape, abs=0.01)


def test_a_body_is_found_by_name_and_title_or_a_hint_is_given() -> None:
    assert library_body("Super35-4Perf") == library_body("super 35 4-perf") == library_body("super35_4perf")
    with pytest.raises(SchemaError, match=r"no camera body named 'alexa' in the library: did you mean alexa_"):
        library_body("alexa")
    with pytest.raises(SchemaError, match="the library has full_frame, vistavision"):
        library_body("xyzzy")


@pytest.mark.parametrize("metres_per_unit", [0.01, 1.0, 0.0254])
def test_a_mounted_body_is_the_camera_s_for_all_time(
    stage: Usd.Stage, camera: LensCamera, metres_per_unit: float
) -> None:
    UsdGeom.SetStageMetersPerUnit(stage, metres_per_unit)
    camera.prim.GetAttribute("horizontalAperture").Set(1.0, 1)
    camera.prim.GetAttribute("horizontalAperture").Set(2.0, 24)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        mount_body(camera, library_body("alexa_35"))
    for time in (1, 12, 24):
        assert apertures(camera, time) == pytest.approx([side / (metres_per_unit * 100) for side in (27.99, 19.22)])
    film = camera.film.read()
    assert (film.body, film.resolution, film.process) == ("ARRI ALEXA 35", (4608, 3164), "none")
    assert camera.prim.GetAttribute("focalLength").Get() == 50
    assert "27.99" not in stage.GetRootLayer().ExportToString()


def test_the_lens_decides_how_far_the_picture_is_stretched_back(camera: LensCamera) -> None:
    gate = library_body("anamorphic_35")
    mount_body(camera, gate)
    assert apertures(camera) == pytest.approx(gate.gate_mm)
    mount_lens(camera, LensData(squeeze=2))
    mount_body(camera, gate)
    assert apertures(camera) == pytest.approx((2 * gate.gate_mm[0], gate.gate_mm[1]))
    mount_body(camera, library_body("super16"))
    assert apertures(camera) == pytest.approx((2 * 12.52, 7.41))
    assert camera.film.read().resolution == (0, 0)


def test_a_body_is_referenced_as_any_prim_is(stage: Usd.Stage) -> None:
    prim = stage.DefinePrim("/cam", "Camera")
    prim.GetReferences().AddReference(str(BODY_LIBRARY_FILE), "/bodies/alexa_mini_anamorphic")
    camera = LensCamera(prim)
    assert apertures(camera) == pytest.approx((2 * 23.76, 17.82))
    assert (camera.lens.read().squeeze, camera.film.read().process) == (2, "digital")
