"""A camera's lens and iris are what its schemas say; the lenses of the library are those of the patents."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from render.errors import CameraError, InputError
from render.model.camera import Camera
from render.model.data_sheet import DataSheet as SheetTables
from render.model.lens import AIR, Glass, Prescription, Surface
from render.optics.glass import refractive_index
from render.optics.lens_files import MeasuredLens, parse_lens_file
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.zooming import marked_close_focus_m, zoom_of
from render.shot.findings.camera_findings import camera_findings
from render.shot.lens.lens_choice import measured_choice
from render.stage import find_not_honoured, read_camera
from render.stage.camera.lens_data import lens_data
from render.stage.camera.lenses import make_iris, make_lens
from render.stage.camera.planes import rotate_plane
from tests.render.kits.glasses import glass
from tests.render.kits.lenses import SIX_LENSES, KnownLens
from tests.render.kits.stages import new_stage, write_picture
from tests.render.kits.zoom_files import FLOATING_TXT, TELE_ZOOM_TXT
from usd_schemas import (
    AberrationScales,
    ApertureData,
    Asset,
    Configurations,
    DataSheet,
    HeightField,
    LensCamera,
    LensData,
    Seidel,
    library_lens,
    library_lenses,
    mount_lens,
)
from usd_schemas import Prescription as PrescriptionData

SINGLET = PrescriptionData(radius=(50.0, -50.0), thickness=(5.0, 0.0), index=(1.5, 1.0), clear_diameter=(20.0, 20.0))


@pytest.fixture
def stage() -> Usd.Stage:
    return new_stage(0.01)


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    return LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())


def _read(stage: Usd.Stage) -> Camera:
    return read_camera(stage, "/cam", 1.0)


@pytest.mark.parametrize("known", SIX_LENSES, ids=lambda known: known.prescription.name)
def test_the_librarys_prescriptions_are_the_patents(stage: Usd.Stage, camera: LensCamera, known: KnownLens) -> None:
    names = ["double_gauss_50", "wide_22", "fisheye_10", "telephoto_250", "planar_50", "distagon_35"]
    entry = library_lens(names[SIX_LENSES.index(known)])
    mount_lens(camera, entry.lens, focal_length_mm=entry.focal_length_mm, f_stop=entry.f_stop)
    lens = _read(stage).lens
    assert lens.prescription is not None
    for got, wanted in zip(lens.prescription.surfaces, known.prescription.surfaces, strict=True):
        assert (got.aspheric, got.is_stop) == (wanted.aspheric, wanted.is_stop)
        numbers = [[s.radius_mm, s.thickness_mm, s.semi_diameter_mm, s.conic, s.glass.index] for s in (got, wanted)]
        assert numbers[0] == pytest.approx(numbers[1])
    assert lens.prescription.f_stop == known.f_stop


@pytest.mark.parametrize("entry", [e for e in library_lenses() if e.lens.prescription.radius], ids=lambda e: e.name)
def test_library_lenses_have_their_stated_focal_length_and_speed(
    stage: Usd.Stage, camera: LensCamera, entry: object
) -> None:
    mount_lens(camera, entry.lens, focal_length_mm=entry.focal_length_mm, f_stop=entry.f_stop)
    prescription = _read(stage).lens.prescription
    assert prescription is not None
    whole = complete_prescription(prescription)
    assert first_order(whole).focal_length_mm == pytest.approx(entry.focal_length_mm, rel=1e-3)
    assert whole.f_stop == pytest.approx(entry.f_stop, rel=0.01)
    assert not any("said to be" in note for note in whole.notes)


def test_the_double_gauss_of_the_library_is_corrected_for_colour(stage: Usd.Stage, camera: LensCamera) -> None:
    # Its Abbe numbers come from another source than its radii; together they must make an achromat, as it was sold.
    mount_lens(camera, library_lens("double_gauss_50").lens)
    prescription = _read(stage).lens.prescription
    assert prescription is not None
    blue, red = (first_order(prescription, nm).back_focal_mm for nm in (475, 650))
    assert 0 < red - blue < 0.002 * 50


def test_sellmeier_coefficients_win_over_index_and_abbe_number(stage: Usd.Stage, camera: LensCamera) -> None:
    mount_lens(camera, library_lens("singlet_50").lens)
    lens = _read(stage).lens
    assert lens.model == "spherical"
    assert lens.prescription is not None
    glass = lens.prescription.surfaces[0].glass
    assert glass.name == "BK7"
    assert refractive_index(glass, 587.5618) == pytest.approx(1.5168, abs=1e-5)
    assert lens.prescription.surfaces[1].glass == AIR


def test_seidel_colours_become_lengths_of_the_right_sign(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.lens.author(
        LensData(model="seidel", seidel=Seidel(w040=2, axial_color=1, lateral_color=1, reference_f_stop=2))
    )
    seidel = _read(stage).lens.seidel
    assert seidel is not None
    assert seidel.w040 == 2
    # One wave at f/2 is 8·2²·0.5876 µm between the C and the F line, and 8 % more from red to blue; blue focuses short.
    assert seidel.axial_color_mm == pytest.approx(-8 * 4 * 0.5875618e-3 * 1.0815, rel=1e-4)
    assert seidel.lateral_color_mm == pytest.approx(-2 * 2 * 0.5875618e-3 * 1.0815, rel=1e-4)


def test_a_singlets_colour_as_a_wavefront_is_that_of_its_glass(stage: Usd.Stage, camera: LensCamera) -> None:
    """Two ways to say one lens: longitudinal colour of a thin singlet is f/V between C and F (Welford 1986, section 6.3)."""
    f_mm, abbe, f_stop = 50.0, 64.17, 4.0
    waves = f_mm / abbe / (8 * f_stop**2) / 0.5875618e-3
    camera.lens.author(LensData(model="seidel", seidel=Seidel(axial_color=waves, reference_f_stop=f_stop)))
    seidel = _read(stage).lens.seidel
    assert seidel is not None
    thin = Prescription((Surface(2 * f_mm * 0.5168, 1e-6, Glass(1.5168, abbe)), Surface(-2 * f_mm * 0.5168, 0.0)))
    stop = replace(thin, surfaces=(replace(thin.surfaces[0], is_stop=True), thin.surfaces[1]))
    blue, red = (first_order(stop, nm).back_focal_mm for nm in (475, 650))
    # A wavefront has no glass: between the lines it runs by Cauchy's law, of which crown glass is 1 % off.
    assert seidel.axial_color_mm == pytest.approx(blue - red, rel=0.015)


def test_light_that_glass_and_filter_leave(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.lens.author(LensData(transmittance=0.8, neutral_density=0.3, squeeze=2.0, name="A lens"))
    lens = _read(stage).lens
    assert (lens.model, lens.squeeze, lens.name) == ("thin", 2.0, "A lens")
    assert lens.transmittance == pytest.approx(0.8 * 0.501187, rel=1e-5)


def test_factors_on_errors_reach_the_lens(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.lens.author(LensData(aberration=AberrationScales(chromatic=2.5, coma=0.0)))
    scales = _read(stage).lens.scales
    assert (scales.chromatic, scales.coma, scales.spherical) == (2.5, 0, 1)


def test_power_drawn_over_the_pupil_reaches_the_lens(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.lens.author(LensData(pupil_power=(1.0, 1.1, 0.9), expressive_blend=0.25))
    lens = _read(stage).lens
    assert (lens.pupil_power, lens.expressive_blend) == ((1.0, 1.1, 0.9), 0.25)
    assert camera_findings(stage, ["/cam"]) == []


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (LensData(pupil_power=(1.0, 0.0)), "lens:expressive:pupilPower .* must be above 0 everywhere, got 1, 0"),
        (LensData(pupil_power=(1.0, math.nan)), "expressive:pupilPower .* must be a finite number"),
        (LensData(f_stop_range=(8.0, 2.0)), "lens:fStopRange .* must be from wide open to closed down, .* got 8 and 2"),
        (LensData(expressive_blend=1.5), "lens:expressive:blend .* must be from 0 to 1, got 1.5"),
    ],
)
def test_power_that_no_lens_can_have_is_refused(data: LensData, message: str) -> None:
    with pytest.raises(CameraError, match=message):
        make_lens(data, "/cam")


def test_a_mask_is_read_as_numbers_and_takes_the_place_of_the_blades(
    stage: Usd.Stage, camera: LensCamera, tmp_path: Path
) -> None:
    mask = np.zeros((8, 8, 1), np.float32)
    mask[0, 7] = 0.75
    file = write_picture(tmp_path / "mask.exr", mask)
    camera.aperture.author(ApertureData(blades=5, mask=Asset(file), radial_weights=(0.0, 1.0)))
    iris = _read(stage).iris
    assert iris.mask is not None
    assert iris.mask[0, 7] == pytest.approx(0.75)  # up and to the right, as in the picture
    assert iris.mask.sum() == pytest.approx(0.75)
    assert (iris.blades, iris.radial_weights) == (0, (0, 1))
    assert _read(stage).iris is iris  # for those who keep what they made of it


def test_eight_bit_masks_are_not_taken_for_srgb(stage: Usd.Stage, camera: LensCamera, tmp_path: Path) -> None:
    file = write_picture(tmp_path / "mask.png", np.full((4, 4, 3), 51, np.uint8))
    camera.aperture.author(ApertureData(mask=Asset(file)))
    mask = _read(stage).iris.mask
    assert mask is not None
    assert mask == pytest.approx(0.2)


def test_a_mask_turns_with_the_iris() -> None:
    plane = np.zeros((64, 64))
    plane[28:36, 48:56] = 1.0  # on the right
    up = rotate_plane(plane, math.pi / 2)
    assert up[8:16, 28:36].min() == pytest.approx(1.0)  # counter-clockwise: at the top
    assert up.sum() == pytest.approx(plane.sum())
    assert rotate_plane(plane, 2 * math.pi) == pytest.approx(plane, abs=1e-9)


def test_large_masks_are_averaged_down(stage: Usd.Stage, camera: LensCamera, tmp_path: Path) -> None:
    stripes = np.tile(np.array([[0, 255]], np.uint8), (2, 2500))[:, :, None]
    camera.aperture.author(ApertureData(mask=Asset(write_picture(tmp_path / "mask.png", stripes))))
    mask = _read(stage).iris.mask
    assert mask is not None
    assert max(mask.shape) <= 2048
    assert mask.mean() == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize("text", [TELE_ZOOM_TXT, FLOATING_TXT], ids=["zoom", "floating"])
def test_positions_of_zoom_and_focus_come_through_usd(stage: Usd.Stage, camera: LensCamera, text: str) -> None:
    read = parse_lens_file(text.encode(), "lens.txt")
    camera.lens.author(lens_data(read))
    written = _read(stage).lens.prescription
    assert written is not None
    places = [each.thicknesses_mm for each in written.configurations]
    assert places == [pytest.approx(each.thicknesses_mm) for each in read.configurations]
    assert [each.object_mm for each in written.configurations] == [each.object_mm for each in read.configurations]
    before, after = zoom_of(read), zoom_of(written)
    assert (before and before.positions) == (after and after.positions)
    assert _read(stage).lens.close_focus_m == pytest.approx(marked_close_focus_m(read))


def test_height_fields_are_scaled_to_millimetres(stage: Usd.Stage, camera: LensCamera, tmp_path: Path) -> None:
    heights = np.linspace(-1, 1, 16, dtype=np.float32).reshape(4, 4, 1)
    file = write_picture(tmp_path / "front.exr", heights)
    field = HeightField(front=Asset(file), scale=(0.01, 5.0))
    camera.lens.author(LensData(model="heightField", prescription=SINGLET, height_field=field))
    lens = _read(stage).lens
    assert lens.height_field is not None
    assert lens.height_field.front == pytest.approx(heights[..., 0] * 0.01, rel=1e-3)  # the file is of half precision
    assert lens.height_field.back is None
    assert _read(stage).lens.height_field is lens.height_field


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (LensData(model="prescription"), "lens:prescription:radius of camera /cam must be an array of at least one"),
        (
            LensData(model="spherical", prescription=PrescriptionData(radius=(1.0,))),
            "2 entries for lens:model spherical",
        ),
        (
            LensData(model="prescription", prescription=replace(SINGLET, index=(1.5,))),
            "lens:prescription:index of camera /cam must be 2 entries, like lens:prescription:radius, got 1",
        ),
        (
            LensData(model="prescription", prescription=replace(SINGLET, stop_surface=2)),
            "lens:prescription:stopSurface of camera /cam must be from -1 to 1, got 2",
        ),
        (
            LensData(model="prescription", prescription=replace(SINGLET, focus_group=(1, 0))),
            "lens:prescription:focusGroup",
        ),
        (
            LensData(model="prescription", prescription=SINGLET, configurations=Configurations(thickness=(1.0,) * 3)),
            "lens:configuration:thickness of camera /cam must be 2 entries for each position, of at most 64 positions, got 3",
        ),
        (
            LensData(model="prescription", prescription=SINGLET, configurations=Configurations((1.0,) * 20_000)),
            "lens:configuration:thickness .* got 20000",
        ),
        (
            LensData(
                model="prescription", prescription=SINGLET, configurations=Configurations((1.0,) * 4, f_stop=(2.0,))
            ),
            "lens:configuration:fStop of camera /cam must be 2 entries, one for each position, got 1",
        ),
        (
            LensData(model="heightField", prescription=SINGLET, height_field=HeightField(front=Asset("./none.exr"))),
            r"lens:heightField:front of camera /cam: ./none.exr is missing",
        ),
    ],
)
def test_a_lens_that_cannot_be_is_named(stage: Usd.Stage, camera: LensCamera, data: LensData, expected: str) -> None:
    camera.lens.author(data)
    with pytest.raises(CameraError, match=expected):
        _read(stage)


@pytest.mark.parametrize("squeeze", [1e30, 10.1, 0.09, 0.0, -2.0, float("nan")])
def test_a_squeeze_beyond_all_lenses_is_refused(squeeze: float) -> None:
    with pytest.raises(
        CameraError, match=r"lens:squeeze of camera /cam must be (from 0\.1 to 10|a finite number), got"
    ):
        make_lens(LensData(squeeze=squeeze), "/cam")


@pytest.mark.parametrize("rotation", [float("inf"), float("nan")])
def test_an_iris_that_is_turned_by_no_number_is_refused(rotation: float) -> None:
    with pytest.raises(CameraError, match=r"aperture:rotation of camera /cam must be a finite number"):
        make_iris(ApertureData(blades=6, rotation=rotation), "/cam")


def test_masks_that_cannot_be_used_are_named(stage: Usd.Stage, camera: LensCamera, tmp_path: Path) -> None:
    for pixels, expected in ((0.0, "lets light through somewhere"), (np.nan, "holds what is no finite number")):
        file = write_picture(tmp_path / f"mask{pixels}.exr", np.full((4, 4, 1), pixels, np.float32))
        camera.aperture.author(ApertureData(mask=Asset(file)))
        with pytest.raises(CameraError, match=expected):
            _read(stage)
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n")
    camera.aperture.author(ApertureData(mask=Asset(str(tmp_path / "broken.png"))))
    with pytest.raises(CameraError, match=r"aperture:mask of camera /cam: .*broken.png cannot be read"):
        _read(stage)


def test_a_prescription_goes_into_usd_and_back(stage: Usd.Stage, camera: LensCamera) -> None:
    asphere = Surface(20.0, 3.0, Glass(1.6, 50.0, name="X"), 8.0, -0.5, (1e-5, 0.0, 2e-9, 0, 0, 0, 0, 0, 1e-20))
    lens = Prescription(
        (asphere, Surface(0.0, 1.0, AIR, 5.0, is_stop=True), Surface(-20.0, 30.0)), (0, 0), 2.0, "A lens"
    )
    camera.lens.author(lens_data(lens))
    assert _read(stage).lens.prescription == lens
    with pytest.raises(InputError, match=r"has a term of r\^22"):
        lens_data(replace(lens, surfaces=(replace(asphere, aspheric=(1e-30,) * 10),)))


def _glass_of_a_shot(stage: Usd.Stage, camera: LensCamera, glass: Glass) -> Glass:
    """The glass of a lens that was mounted on the camera and read again."""
    lens = Prescription((Surface(20.0, 3.0, glass, 8.0, is_stop=True), Surface(-20.0, 30.0)), None, 2.0, "A lens")
    camera.lens.author(lens_data(lens))
    read = _read(stage).lens.prescription
    assert read is not None
    return read.surfaces[0].glass


@pytest.mark.parametrize("name", ["N-BK7", "FCD1", "F2_CDGM", "SK19", "E48R"])
def test_glass_of_the_catalogue_keeps_its_dispersion_in_a_shot(name: str, stage: Usd.Stage, camera: LensCamera) -> None:
    known, wavelengths = glass(name), np.linspace(400.0, 700.0, 31)
    read = _glass_of_a_shot(stage, camera, known)
    assert read.name == name
    assert refractive_index(read, wavelengths) == pytest.approx(refractive_index(known, wavelengths), rel=1e-14)


def test_foreign_glass_is_carried_as_sellmeier_coefficients(stage: Usd.Stage, camera: LensCamera) -> None:
    foreign = replace(glass("FCD1"), name="MY-OWN")
    read = _glass_of_a_shot(stage, camera, foreign)
    assert read.sellmeier_b is not None
    wavelengths = np.linspace(400.0, 700.0, 31)
    assert refractive_index(read, wavelengths) == pytest.approx(refractive_index(foreign, wavelengths), abs=1e-6)


def test_a_name_alone_does_not_change_the_glass(stage: Usd.Stage, camera: LensCamera) -> None:
    assert _glass_of_a_shot(stage, camera, Glass(1.5, 60.0, name="FCD1")) == Glass(1.5, 60.0, name="FCD1")
    assert _glass_of_a_shot(stage, camera, Glass(1.497, 0.0, name="FCD1")).dispersion is None


def test_what_is_honoured_is_no_finding_and_what_is_not_is(stage: Usd.Stage, camera: LensCamera) -> None:
    entry = library_lens("soft_focus_85")
    mount_lens(camera, entry.lens, aperture=entry.aperture)
    assert find_not_honoured(stage) == []
    camera.lens.author(
        LensData(model="dataSheet", data_sheet=DataSheet(height=(0.0,), distortion=(0.0,)), entrance_pupil_offset=9.0)
    )
    findings = {finding.path: finding.code for finding in find_not_honoured(stage)}
    assert findings == {"/cam.lens:entrancePupilOffset": "not_honoured"}
    assert _read(stage).lens.data_sheet == SheetTables((0.0,), distortion=(0.0,))


def test_a_data_sheet_goes_through_usd_and_back(stage: Usd.Stage, camera: LensCamera) -> None:
    sheet = SheetTables(
        (0.0, 10.0, 20.0),
        distortion=(0.0, -0.01, -0.02),
        light=(1.0, 0.8, 0.4),
        sagittal_blur_mm=(0.01, 0.02, 0.03),
        tangential_blur_mm=(0.01, 0.02, 0.04),
        spherical=(0.1, 0.2, 0.3),
        coma_mm=(0.0, 0.01, -0.01),
        field_curvature_mm=(0.0, 0.1, 0.2),
        lateral_color_mm=(0.0, 0.001, 0.002),
        axial_color_mm=(0.03, 0.04, 0.05),
        f_stop=1.4,
    )
    measured = MeasuredLens("Some 50/1.4", 50.0, sheet, (1.4, 16.0), 0.45, ("measured on a bench",))
    choice = measured_choice(measured)
    mount_lens(camera, choice.lens, focal_length_mm=choice.focal_length_mm, f_stop=choice.f_stop)
    lens = _read(stage).lens
    assert (lens.model, lens.data_sheet, lens.close_focus_m) == ("dataSheet", sheet, 0.45)
    assert (choice.f_stop, choice.focal_length_mm, choice.notes) == (1.4, 50.0, ("measured on a bench",))
    camera.lens.author(replace(choice.lens, data_sheet=replace(choice.lens.data_sheet, f_stop=0.0)))
    assert _read(stage).lens.data_sheet == sheet  # the f-number wide open stands for one that is not said


def test_an_impossible_data_sheet_is_reported(stage: Usd.Stage, camera: LensCamera) -> None:
    camera.lens.author(LensData(model="dataSheet"))
    with pytest.raises(CameraError, match=r"lens:table of camera /cam: .* must increase from 0, got none"):
        _read(stage)
