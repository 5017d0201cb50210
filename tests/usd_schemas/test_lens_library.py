"""The lens library: whole, legal, findable, and mountable on any camera."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from pxr import Usd, UsdGeom

import usd_schemas
from usd_schemas import AberrationScales, ApertureData, LensCamera, LensData, SchemaError, Seidel, mount_lens
from usd_schemas.lens_library import LIBRARY_FILE, library_lens, library_lenses
from usd_schemas.lens_search import FAMILIES, LensSearch
from usd_schemas.units import tenths_from_mm
from usd_schemas.validation import validate


@pytest.fixture
def stage() -> Usd.Stage:
    return Usd.Stage.CreateInMemory()


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    return LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())


def test_the_lenses_of_the_patents_are_there_and_ours_beside_them() -> None:
    names = usd_schemas.lens_names()
    assert names[:6] == ["double_gauss_50", "wide_22", "fisheye_10", "telephoto_250", "planar_50", "distagon_35"]
    assert {library_lens(name).lens.model for name in names} == {
        "prescription",
        "pinhole",
        "thin",
        "seidel",
        "spherical",
        "dataSheet",
    }


def test_the_library_keeps_the_rules_of_the_schemas() -> None:
    library = Usd.Stage.Open(str(LIBRARY_FILE))
    assert validate(library) == []


@pytest.mark.parametrize("entry", library_lenses(), ids=lambda entry: entry.name)
def test_each_lens_says_what_a_list_of_lenses_shows(entry: usd_schemas.LibraryLens) -> None:
    assert entry.description.endswith(".")
    assert "\n" not in entry.description
    [(shortest, engraved)] = re.findall(r"(\d+-)?(\d+) mm", entry.lens.name)
    if shortest:  # zooms are engraved with round numbers
        engraved_mm = float(shortest[:-1]), float(engraved)
        assert entry.focal_length_range_mm == pytest.approx(engraved_mm, rel=0.05)
        assert entry.focal_length_mm == pytest.approx(entry.focal_length_range_mm[0], rel=1e-3)
    else:
        assert entry.focal_length_range_mm is None
        assert entry.focal_length_mm == pytest.approx(float(engraved), rel=0.02)
    assert f"f/{entry.f_stop:g}" in entry.lens.name or entry.lens.model == "pinhole"
    assert entry.name.split("_")[-2 if entry.name.endswith("2x") else -1] in entry.lens.name
    assert (entry.lens.f_stop_range[0], entry.f_stop > 0) == (entry.f_stop, entry.lens.model != "pinhole")


@pytest.mark.parametrize("entry", library_lenses(), ids=lambda entry: entry.name)
def test_each_lens_says_whence_it_is_and_what_it_is(entry: usd_schemas.LibraryLens) -> None:
    assert entry.families
    assert set(entry.families) <= set(FAMILIES)
    assert ("fast" in entry.families) == (0 < entry.f_stop <= 1.5)
    assert entry.source
    assert (entry.source == "ours") == (entry.year is None)
    assert (entry.stated is None) == (entry.source == "ours" or entry.lens.model == "dataSheet")
    if entry.stated is not None:
        assert entry.focal_length_mm == pytest.approx(entry.stated.focal_length_mm, rel=0.01)


def test_every_family_is_known_and_has_a_lens() -> None:
    assert {family for entry in library_lenses() for family in entry.families} == set(FAMILIES)


def test_a_zoom_keeps_the_focal_lengths_within_its_range(stage: Usd.Stage, camera: LensCamera) -> None:
    zoom = library_lens("tele_zoom_70_200")
    focal_length = camera.prim.GetAttribute("focalLength")
    for time, mm in ((1, 80.0), (24, 190.0)):
        focal_length.Set(tenths_from_mm(mm, stage), time)
    kept = [focal_length.Get(time) for time in (1, 24)]
    mounted = mount_lens(camera, zoom.lens, focal_length_mm=zoom.focal_length_mm, f_stop=zoom.f_stop)
    assert mounted.focal_length_mm is None
    assert [focal_length.Get(time) for time in (1, 24)] == kept
    mount_lens(camera, library_lens("planar_50").lens, focal_length_mm=50)
    assert mount_lens(camera, zoom.lens, focal_length_mm=72.09).focal_length_mm == pytest.approx(72.1)
    focal_length.Set(focal_length.Get() * 10)
    assert mount_lens(camera, zoom.lens, focal_length_mm=72.09).focal_length_mm == pytest.approx(194.01)


def test_a_zoom_is_found_by_any_focal_length_of_its_range() -> None:
    zoom = library_lens("tele_zoom_70_200")
    found = [LensSearch(focal_length_mm=(mm, mm)).finds(zoom) for mm in (50, 72.1, 135, 194, 250)]
    assert found == [False, True, True, True, False]


def test_a_lens_is_found_in_any_letter_case_or_a_hint_is_given() -> None:
    assert library_lens("Planar-50").name == "planar_50"
    with pytest.raises(SchemaError, match=r"no lens named 'planar' in the library: did you mean planar_50"):
        library_lens("planar")
    with pytest.raises(SchemaError, match=r"the library has double_gauss_50, wide_22"):
        library_lens("xyzzy")


@pytest.mark.parametrize("metres_per_unit", [0.01, 1.0, 0.0254])
def test_a_mounted_lens_is_the_camera_s(stage: Usd.Stage, camera: LensCamera, metres_per_unit: float) -> None:
    UsdGeom.SetStageMetersPerUnit(stage, metres_per_unit)
    entry = library_lens("double_gauss_50")
    mounted = mount_lens(camera, entry.lens, focal_length_mm=entry.focal_length_mm, f_stop=entry.f_stop)
    assert camera.lens.read() == entry.lens
    assert camera.prim.GetAttribute("focalLength").Get() == pytest.approx(50.36 / (metres_per_unit * 100))
    assert (mounted.focal_length_mm, mounted.f_stop) == (50.36, 2.0)  # USD's own f-number, 0, is no iris of a lens
    assert camera.prim.GetAttribute("fStop").Get() == pytest.approx(2.0)


def test_an_f_number_that_the_lens_has_stays(camera: LensCamera) -> None:
    camera.prim.GetAttribute("fStop").Set(4.0)
    assert mount_lens(camera, LensData(), f_stop=2.0).f_stop is None
    assert camera.prim.GetAttribute("fStop").Get() == 4.0


def test_only_those_keys_of_the_iris_are_raised_that_the_lens_has_not(camera: LensCamera) -> None:
    for time, f_stop in ((1, 1.4), (24, 2.8)):
        camera.set_key("fStop", time, f_stop)
    assert mount_lens(camera, LensData(), f_stop=2.0).f_stop == 2.0
    assert [key.value for key in camera.keys("fStop")] == pytest.approx([2.0, 2.8])


def test_another_lens_keeps_only_the_photographers_settings(camera: LensCamera) -> None:
    before = library_lens("planar_50")
    mount_lens(camera, before.lens, focal_length_mm=50)
    set_by_hand = replace(
        camera.lens.read(), neutral_density=0.6, breathing=True, aberration=AberrationScales(chromatic=2)
    )
    camera.lens.author(set_by_hand)
    camera.set_key("lens:seidel:w040", 1, 3.0)
    after = library_lens("soft_focus_85")
    mount_lens(camera, after.lens, focal_length_mm=85, aperture=after.aperture)
    wanted = replace(after.lens, neutral_density=0.6, breathing=True, aberration=AberrationScales(chromatic=2))
    assert camera.lens.read() == wanted
    assert camera.lens.read(1.0) == wanted  # keys of the lens before do not shine through
    assert camera.aperture.read() == after.aperture


def test_a_lens_is_mounted_over_a_weaker_layer_s_keys(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.prim.GetAttribute("focalLength").Set(24.0, 1)
    camera.prim.GetAttribute("focalLength").Set(70.0, 48)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        mount_lens(camera, LensData(model="seidel", seidel=Seidel(w040=5)), focal_length_mm=85)
    assert camera.prim.GetAttribute("focalLength").Get(24.0) == 85.0
    assert not stage.GetRootLayer().ExportToString().count("85")


def test_the_iris_of_a_camera_stays_where_the_lens_has_none(camera: LensCamera) -> None:
    camera.aperture.author(ApertureData(blades=7))
    mount_lens(camera, library_lens("planar_50").lens)
    assert camera.aperture.read().blades == 7


def test_a_lenss_iris_goes_with_it_and_the_cameras_own_returns(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.aperture.author(ApertureData(blades=7))
    mirror, planar = library_lens("mirror_500"), library_lens("planar_50")
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        mount_lens(camera, mirror.lens, aperture=mirror.aperture)
        assert camera.aperture.read() == mirror.aperture
        mount_lens(camera, planar.lens, aperture=planar.aperture)
    assert camera.aperture.read() == ApertureData(blades=7)


def test_the_iris_of_a_lens_in_a_weaker_layer_goes_with_it_too(stage: Usd.Stage, camera: LensCamera) -> None:
    mirror = library_lens("mirror_500")
    mount_lens(camera, mirror.lens, aperture=mirror.aperture)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        mount_lens(camera, library_lens("planar_50").lens)
    assert camera.aperture.read() == ApertureData()
