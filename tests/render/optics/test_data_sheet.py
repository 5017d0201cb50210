"""A lens by data sheet: its rays have the errors that its tables say."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from render.errors import SettingsError
from render.lab.reference.lens_rays import lens_rays
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.data_sheet import DataSheet
from render.model.lens import AberrationScales, Lens
from render.optics.data_sheet import SheetErrors, at_heights, open_pupil, sheet_errors
from render.optics.distortion import chief_rays
from render.trace.data_sheet_table import make_data_sheet_table
from render.trace.field_focus import field_focus
from render.trace.sharpness import rays_of_heights
from tests.render.kits.data_sheets import SHEET

HEIGHTS = np.array(SHEET.heights_mm)


def set_to(sheet: DataSheet, f_stop: float, **scales: float) -> SheetErrors:
    heights = np.array(sheet.heights_mm)
    return sheet_errors(sheet, heights, focal_length_mm=50, f_stop=f_stop, scales=AberrationScales(**scales))


def random_disc(count: int = 200_000) -> DoubleArray:
    radius, turn = np.random.default_rng(1).uniform(size=(2, count))
    return np.sqrt(radius)[:, None] * np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)], axis=1)


def test_a_points_light_spreads_and_passes_as_the_sheet_says() -> None:
    """Thrown rays, of which the rims stop some: an integral of its own."""
    errors, pupil = set_to(SHEET, 1.4), random_disc()
    lands = errors.landing_mm(pupil)
    is_open = np.maximum(errors.clearance(pupil, 1), errors.clearance(pupil, -1)) <= 0
    spread = np.array([points[row].std(axis=0) for points, row in zip(lands, is_open, strict=True)])
    np.testing.assert_allclose(spread[:, 0], SHEET.tangential_blur_mm, rtol=0.01)
    np.testing.assert_allclose(spread[:, 1], SHEET.sagittal_blur_mm, rtol=0.01)
    np.testing.assert_allclose(is_open.mean(axis=1) * errors.natural, SHEET.light, atol=0.003)
    np.testing.assert_allclose(errors.light, SHEET.light, atol=2e-4)
    np.testing.assert_allclose(errors.spread_mm()[:, 0], SHEET.tangential_blur_mm, rtol=1e-3)


def test_errors_alone_have_their_closed_forms() -> None:
    coma = set_to(DataSheet((0.0, 10.0), coma_mm=(0.0, 0.3), f_stop=2.0), 2.0)
    np.testing.assert_allclose(coma.spread_mm()[1], [0.1 * np.sqrt(1 / 2), 0.1 * np.sqrt(1 / 6)], rtol=1e-4)
    farthest = coma.landing_mm(np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]]))[1]
    np.testing.assert_allclose(farthest, [[0.3, 0], [0.3, 0], [0.1, 0]], atol=1e-12)  # the flare points outward
    curved = DataSheet((0.0, 10.0), field_curvature_mm=(0.0, 0.8), f_stop=2.0)
    for f_stop in (2.0, 4.0):  # a disc of diameter z/N, whose standard deviation is a quarter of that
        np.testing.assert_allclose(set_to(curved, f_stop).spread_mm()[1], 0.8 / f_stop / 4, rtol=1e-4)
    axial = set_to(DataSheet((0.0,), axial_color_mm=(0.7,), f_stop=2.0), 2.0)
    np.testing.assert_allclose(axial.spread_mm(475), 0.35 / 2 / 4, rtol=1e-4)  # half the way from the middle to blue
    lateral = set_to(DataSheet((0.0, 10.0), lateral_color_mm=(0.0, 0.02)), 8.0)
    red, blue = (lateral.landing_mm(np.zeros((1, 2)), wavelength)[1, 0] for wavelength in (650.0, 475.0))
    np.testing.assert_allclose(red - blue, [0.02, 0], atol=1e-12)  # red lies farther out


@pytest.mark.parametrize(("stops", "blur"), [(0, 0.02), (1, 0.02 / 2**1.5), (2, 0.02 / 8)])
def test_blur_shrinks_with_the_third_power_of_the_iris(stops: int, blur: float) -> None:
    """As spherical aberration does (Kyaw 2013, eq. 6.3)."""
    sheet = DataSheet((0.0, 10.0), sagittal_blur_mm=(0.02, 0.02), tangential_blur_mm=(0.02, 0.02), f_stop=2.0)
    np.testing.assert_allclose(set_to(sheet, 2.0 * np.sqrt(2) ** stops).spread_mm(), blur, rtol=1e-4)


@pytest.mark.parametrize(("share", "brighter"), [(0.8, "edge"), (-0.8, "middle"), (0.0, "neither")])
def test_spherical_aberration_sets_where_a_disc_is_bright(share: float, brighter: str) -> None:
    blur = (0.02, 0.02)
    sheet = DataSheet((0.0, 10.0), sagittal_blur_mm=blur, tangential_blur_mm=blur, spherical=(share, share), f_stop=2.0)
    errors, pupil = set_to(sheet, 2.0), random_disc()
    np.testing.assert_allclose(errors.spread_mm(), 0.02, rtol=1e-3)
    disc = errors.landing_mm(pupil)[1] + 0.8 * pupil  # behind the focus light from the outer side lands farther out
    radius = np.hypot(*disc.T)
    inner = np.mean(radius < radius.max() / np.sqrt(2))  # share of the light in half of the area
    assert {"edge": inner < 0.47, "middle": inner > 0.53, "neither": abs(inner - 0.5) < 0.015}[brighter]


def test_stopped_down_rims_no_longer_block() -> None:
    closed = set_to(SHEET, 5.6)
    cos4 = (1 + (HEIGHTS / 50) ** 2 / (1 + np.array(SHEET.distortion)) ** 2) ** -2.0
    np.testing.assert_allclose(closed.light, np.maximum(cos4, SHEET.light), rtol=1e-4)
    assert (set_to(SHEET, 2.0).light[1:] > np.array(SHEET.light)[1:]).all()


def test_the_open_pupil_is_what_two_circles_have_in_common() -> None:
    _, weights = open_pupil(1.0, np.array([0.0, 0.3]), 1.0)
    lens = 2 * np.arccos(0.3) - 2 * 0.3 * np.sqrt(1 - 0.3**2)
    np.testing.assert_allclose(weights.sum(axis=1), [np.pi, lens], rtol=1e-6)


def test_tables_are_joined_smoothly_and_stay_beyond_their_end() -> None:
    x = np.linspace(5, 15, 101)  # between the second knot and the last but one the slopes are scipy's
    ours = at_heights(SHEET, "tangential_blur_mm", x)
    np.testing.assert_allclose(ours, PchipInterpolator(HEIGHTS, SHEET.tangential_blur_mm)(x), atol=1e-12)
    assert at_heights(SHEET, "light", np.array([0.0, 30.0])).tolist() == [1.0, 0.35]
    assert at_heights(DataSheet((0.0,)), "light", np.array([9.0])) == 1.0


def test_the_table_of_the_tracer_has_the_same_rays() -> None:
    no_colour = AberrationScales(chromatic=0.0)
    table = make_data_sheet_table(
        SHEET, no_colour, focal_length_mm=50, pupil_radius_m=0.05 / 2.8, last_slope=0.432, wavelengths_nm=(510.0,)
    )
    heights = np.linspace(0, 21.6, table.rows.shape[1])
    slope, pupil, is_open = rays_of_heights(table)
    errors = sheet_errors(SHEET, heights, focal_length_mm=50, f_stop=1.4, scales=no_colour)
    lands = errors.landing_mm(pupil / (0.05 / 2.8))
    wanted = -lands * errors.stretch[:, None] / 50
    wanted[..., 0] += (errors.seen - heights / 50)[:, None]
    np.testing.assert_allclose(slope, wanted, atol=2e-8)
    spread = (
        np.array([points[row].std(axis=0) for points, row in zip(slope, is_open, strict=True)]) * 50 / errors.stretch
    )
    np.testing.assert_allclose(spread[:, 0], at_heights(SHEET, "tangential_blur_mm", heights), rtol=0.04)


def test_each_factor_works_on_its_own_errors() -> None:
    none = set_to(SHEET, 1.4, spherical=0, coma=0, astigmatism=0, field_curvature=0, distortion=0, chromatic=0)
    np.testing.assert_array_equal(none.landing_mm(random_disc(100), 475.0), 0.0)
    np.testing.assert_allclose(none.seen, HEIGHTS / 50)
    double = set_to(SHEET, 1.4, distortion=2.0)
    np.testing.assert_allclose(double.seen - HEIGHTS / 50, 2 * (set_to(SHEET, 1.4).seen - HEIGHTS / 50))


def test_places_and_sharpness_know_the_sheet() -> None:
    lens = Lens("dataSheet", data_sheet=replace(SHEET, axial_color_mm=(), spherical=(), light=()))
    camera = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.4, focus_distance_m=3.0, near_m=0.1, lens=lens)
    chief = chief_rays(camera)
    assert chief is not None
    np.testing.assert_allclose(
        chief.undistort_slopes(np.array([[0.3, 0.0]])), [[15 / (1 - 0.015) / 50, 0]], rtol=1e-5
    )  # 15 mm on the film
    sharp = field_focus(camera)
    assert sharp is not None
    curvature = at_heights(SHEET, "field_curvature_mm", sharp.heights * 50)
    # image z before the film: what is sharp there is 1000·z/f² nearer than the plane of focus
    np.testing.assert_allclose(sharp.shift_w[:20], (curvature / 2.5)[:20], atol=2e-4)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"heights_mm": (0.0, 5.0, 3.0)}, "must increase from 0, got 0, 5, 3"),
        ({"heights_mm": ()}, "must increase from 0, got none"),
        ({"coma_mm": (0.1,)}, "coma_mm must have 3 entries, got 1"),
        ({"light": (1.0, 0.5, -0.1)}, "light must be from 0 to 2, got 1, 0.5, -0.1"),
        ({"light": (0.0, 0.5, 0.1)}, "light must be above 0 on the axis"),
        ({"spherical": (0.0, 1.5, 0.0)}, "spherical must be from -1 to 1"),
        ({"sagittal_blur_mm": (0.0, float("nan"), 0.0)}, "sagittal_blur_mm must be from 0 to 1000 mm"),
        ({"distortion": (0.0, 0.0, 1.5)}, "must not fold the picture"),
        ({"f_stop": -1.0}, "f-number must be from 0 to 1000"),
    ],
)
def test_impossible_tables_are_reported(wrong: dict[str, object], words: str) -> None:
    with pytest.raises(SettingsError) as caught:
        DataSheet(**{"heights_mm": (0.0, 10.0, 20.0)} | wrong)  # type: ignore[arg-type]
    assert words in caught.value.detail


def test_the_ray_by_ray_reference_says_that_it_knows_none() -> None:
    lens = Lens("dataSheet", data_sheet=SHEET)
    camera = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.4, focus_distance_m=3.0, near_m=0.1, lens=lens)
    with pytest.raises(SettingsError, match="no lens by its data sheet"):
        lens_rays(camera, np.zeros((1, 2)), (0.3, 0.2))
