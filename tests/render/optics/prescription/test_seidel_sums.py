"""Exactly traced lenses against third-order theory (Welford 1986, ch. 6 and 8): powers, signs and sizes of each error."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.model.arrays import DoubleArray
from render.model.lens import Glass, Prescription, Surface
from render.optics.glass import C_LINE_NM, D_LINE_NM, F_LINE_NM
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.seidel_sums import SeidelSums, seidel_sums
from render.optics.prescription.tracing import trace_forward
from tests.render.kits.glasses import glass
from tests.render.kits.lenses import SIX_LENSES, KnownLens

NAMES = [lens.prescription.name for lens in SIX_LENSES]
BICONVEX = Prescription(
    (Surface(100.0, 6.0, Glass(1.5168, 64.17), 30.0, is_stop=True), Surface(-100.0, 0.0, semi_diameter_mm=30.0)),
    name="Biconvex",
)


def with_stop_before(distance_mm: float) -> Prescription:
    """The biconvex lens with its stop that far before it."""
    lens = (replace(BICONVEX.surfaces[0], is_stop=False), BICONVEX.surfaces[1])
    return replace(BICONVEX, surfaces=(Surface(0.0, distance_mm, semi_diameter_mm=10.0, is_stop=True), *lens))


def landing(
    lens: Prescription,
    pupil: DoubleArray,
    field_slope: float,
    wavelength_nm: float = D_LINE_NM,
    defocus_mm: float = 0.0,
) -> DoubleArray:
    """``(n, 2)`` where parallel light lands on the d line's paraxial image plane; pupil points ``(n, 2)`` in mm."""
    first = first_order(lens)
    points = np.column_stack([pupil, np.full(len(pupil), first.entrance_pupil_mm)])
    directions = np.tile(np.array([0.0, field_slope, 1.0]) / np.hypot(1.0, field_slope), (len(pupil), 1))
    traced = trace_forward(lens, points, directions, wavelength_nm, clip=False)
    return traced.at(first.length_mm + first.back_focal_mm + defocus_mm)


def ring(radius_mm: float, count: int = 8) -> DoubleArray:
    """Pupil points on a circle; the first one up, the third one to the side."""
    angle = 2 * np.pi * np.arange(count) / count
    return radius_mm * np.column_stack([np.sin(angle), np.cos(angle)])


def growth(sizes: DoubleArray, of: DoubleArray) -> DoubleArray:
    """Power with which sizes grow."""
    return np.diff(np.log(np.abs(sizes))) / np.diff(np.log(of))


def focus_of_narrow_beam(lens: Prescription, field_slope: float) -> tuple[float, float]:
    """Defocus in mm at which a narrow oblique beam has its tangential and its sagittal line."""
    width = 1e-3
    near, far = (landing(lens, ring(width, 4), field_slope, defocus_mm=defocus) for defocus in (0.0, 1.0))
    foci = []
    for up, down, axis in ((0, 2, 1), (1, 3, 0)):
        spread = [(land[up] - land[down])[axis] for land in (near, far)]
        foci.append(spread[0] / (spread[0] - spread[1]))
    return foci[0], foci[1]


def totals(sums: SeidelSums) -> dict[str, float]:
    return {name: float(values.sum()) for name, values in vars(sums).items()}


def test_spherical_aberration_grows_with_the_cube_of_the_aperture() -> None:
    radii = np.array([1.0, 2.0, 4.0])
    off_axis = landing(BICONVEX, np.column_stack([0 * radii, radii]), 0.0)[:, 1]
    assert growth(off_axis, radii) == pytest.approx([3, 3], abs=0.01)
    assert (off_axis < 0).all()  # undercorrected: the edge's rays cross the axis before the paraxial focus


def test_spherical_aberration_depends_on_the_bending_as_theory_has_it() -> None:
    # Of thin lenses of index n for parallel light, least at the shape factor 2(n² − 1)/(n + 2) (Welford 1986, ch. 12).
    index, focal, radius = 1.5, 100.0, 1.0

    def bent(shape: float) -> Prescription:
        front, back = 2 * focal * (index - 1) / (shape + 1), 2 * focal * (index - 1) / (shape - 1)
        return Prescription((Surface(front, 1e-6, Glass(index), 5.0, is_stop=True), Surface(back, 0.0)))

    shapes = np.linspace(-0.5, 2.5, 61)
    shapes = shapes[(np.abs(shapes - 1) > 1e-9) & (np.abs(shapes + 1) > 1e-9)]
    off_axis = [abs(landing(bent(shape), np.array([[0.0, radius]]), 0.0)[0, 1]) for shape in shapes]
    assert shapes[int(np.argmin(off_axis))] == pytest.approx(2 * (index**2 - 1) / (index + 2), abs=0.05)


def test_coma_grows_with_the_aperture_squared_and_with_the_field() -> None:
    lens = with_stop_before(30.0)
    radii, slopes = np.array([1.0, 2.0, 4.0]), np.array([0.002, 0.004, 0.008])

    def tangential_coma(radius: float, slope: float) -> float:
        up, down, middle = landing(lens, np.array([[0.0, radius], [0.0, -radius], [0.0, 0.0]]), slope)[:, 1]
        return float((up + down) / 2 - middle)

    by_radius = np.array([tangential_coma(radius, 0.004) for radius in radii])
    by_field = np.array([tangential_coma(4.0, slope) for slope in slopes])
    assert growth(by_radius, radii) == pytest.approx([2, 2], abs=0.03)
    assert growth(by_field, slopes) == pytest.approx([1, 1], abs=0.03)


@pytest.mark.parametrize("stop_before_mm", [0.0, 60.0])
def test_comas_sign_and_three_to_one_shape_follow_the_seidel_sum(stop_before_mm: float) -> None:
    lens, slope, radius = with_stop_before(stop_before_mm), 0.01, 3.0
    first = first_order(lens)
    sums = totals(seidel_sums(lens, first.focal_length_mm / (2 * radius), slope * first.focal_length_mm))
    rays = landing(lens, np.vstack([ring(radius), [[0.0, 0.0]]]), slope)
    tangential = (rays[0, 1] + rays[4, 1]) / 2 - rays[8, 1]
    sagittal = (rays[2, 1] + rays[6, 1]) / 2 - rays[8, 1]
    # ∂W/∂ρ over the slope of the marginal ray, which goes down: 3/2·S_II tangentially
    assert tangential == pytest.approx(-1.5 * sums["coma"] * 2 * first.focal_length_mm / (2 * radius), rel=0.02)
    assert tangential / sagittal == pytest.approx(3, rel=0.02)


def test_coma_changes_its_sign_as_the_stop_moves_through_the_lens() -> None:
    comas = [totals(seidel_sums(with_stop_before(z), 8.0, 5.0))["coma"] for z in (0.0, 120.0)]
    assert comas[0] * comas[1] < 0


def test_astigmatism_and_field_curvature_grow_with_the_field_squared() -> None:
    slopes = np.array([0.02, 0.04, 0.08])
    foci = np.array([focus_of_narrow_beam(BICONVEX, slope) for slope in slopes])
    assert growth(foci[:, 0] - foci[:, 1], slopes) == pytest.approx([2, 2], abs=0.03)
    assert growth(foci[:, 1], slopes) == pytest.approx([2, 2], abs=0.03)
    # a thin lens at the stop: both lines lie before the image plane, the tangential one farther
    assert (foci[:, 0] < foci[:, 1]).all()
    assert (foci[:, 1] < 0).all()


def test_blur_by_astigmatism_grows_with_the_aperture() -> None:
    radii = np.array([0.1, 0.2, 0.4])
    spread = [np.ptp(landing(BICONVEX, ring(radius), 0.05)[:, 1]) for radius in radii]
    assert growth(np.array(spread), radii) == pytest.approx([1, 1], abs=0.02)


@pytest.mark.parametrize("lens", [BICONVEX, with_stop_before(15.0), *(lens.prescription for lens in SIX_LENSES)])
def test_astigmatic_lines_lie_3_to_1_about_the_petzval_surface(lens: Prescription) -> None:
    first, slope = first_order(lens), 0.01
    tangential, sagittal = focus_of_narrow_beam(lens, slope)
    height = slope * first.focal_length_mm
    petzval = (3 * sagittal - tangential) / 2
    assert petzval == pytest.approx(-(height**2) * first.petzval_sum / 2, rel=0.02, abs=1e-7 * first.focal_length_mm)


@pytest.mark.parametrize("lens", SIX_LENSES, ids=NAMES)
def test_seidel_sums_predict_where_exact_rays_land(lens: KnownLens) -> None:
    first = first_order(lens.prescription)
    f_stop, slope = 40 * lens.f_stop, 0.02
    height, radius = slope * first.focal_length_mm, first.focal_length_mm / (2 * f_stop)
    sums = totals(seidel_sums(lens.prescription, f_stop, height))
    pupil, chief = ring(1.0), np.zeros((1, 2))
    for field in (0.0, 1.0):
        x, y = np.vstack([pupil, chief]).T
        blur = sums["spherical"] / 2 * (x * x + y * y) + field**2 * (sums["astigmatism"] + sums["petzval"]) / 2
        across = blur * x + sums["coma"] * field * x * y
        along = blur * y + sums["coma"] / 2 * field * (x * x + 3 * y * y) + sums["astigmatism"] * field**2 * y
        predicted = -2 * f_stop * np.column_stack([across, along + sums["distortion"] / 2 * field**3])
        exact = landing(lens.prescription, np.vstack([pupil, chief]) * radius, field * slope) - [0.0, field * height]
        assert exact == pytest.approx(predicted, abs=0.005 * np.abs(predicted).max())


def test_a_wide_lens_of_positive_distortion_sum_draws_barrels() -> None:
    lens = with_stop_before(40.0)
    assert totals(seidel_sums(lens, 10.0, 10.0))["distortion"] > 0
    first, slope = first_order(lens), 0.2
    assert landing(lens, np.zeros((1, 2)), slope)[0, 1] < slope * first.focal_length_mm


def test_blue_light_of_a_simple_lens_focuses_nearest_to_it() -> None:
    blue, yellow, red = (first_order(BICONVEX, line).back_focal_mm for line in (F_LINE_NM, D_LINE_NM, C_LINE_NM))
    assert blue < yellow < red
    # F to C, a thin lens's focus moves by its focal length over the Abbe number
    assert red - blue == pytest.approx(first_order(BICONVEX).focal_length_mm / 64.17, rel=0.03)


def test_an_achromat_brings_blue_and_red_together() -> None:
    crown, flint = glass("N-BK7"), glass("N-SF10")
    share = crown.abbe / (crown.abbe - flint.abbe)
    power = np.array([share, 1 - share]) / 100.0
    middle = -1 / (power[0] / (crown.index - 1) / 2)
    last = 1 / (1 / middle - power[1] / (flint.index - 1))
    doublet = Prescription(
        (Surface(-middle, 1e-3, crown, 9.0, is_stop=True), Surface(middle, 1e-3, flint), Surface(last, 0.0))
    )
    blue, green, red = (first_order(doublet, line).back_focal_mm for line in (F_LINE_NM, 546.07, C_LINE_NM))
    assert abs(red - blue) < 0.01
    assert green < min(blue, red)  # what is left is the secondary spectrum


@pytest.mark.parametrize(("stop_before_mm", "blue_is_higher"), [(40.0, False), (-40.0, True)])
def test_lateral_colour_changes_its_sign_with_the_side_of_the_stop(stop_before_mm: float, blue_is_higher: bool) -> None:
    lens = with_stop_before(stop_before_mm) if stop_before_mm > 0 else with_stop_behind(-stop_before_mm)
    blue, red = (landing_of_chief(lens, 0.1, line) for line in (F_LINE_NM, C_LINE_NM))
    assert (blue > red) == blue_is_higher


def with_stop_behind(distance_mm: float) -> Prescription:
    front, back = (replace(surface, is_stop=False) for surface in BICONVEX.surfaces)
    stop = Surface(0.0, 0.0, semi_diameter_mm=10.0, is_stop=True)
    return replace(BICONVEX, surfaces=(front, replace(back, thickness_mm=distance_mm), stop))


def landing_of_chief(lens: Prescription, slope: float, wavelength_nm: float) -> float:
    """Image height of the ray through the middle of the stop, as seen at that wavelength."""
    pupil = first_order(lens, wavelength_nm).entrance_pupil_mm
    shift = (first_order(lens).entrance_pupil_mm - pupil) * slope
    return float(landing(lens, np.array([[0.0, shift]]), slope, wavelength_nm)[0, 1])


@pytest.mark.parametrize("lens", SIX_LENSES[4:], ids=NAMES[4:])
def test_colour_sums_predict_focus_and_scale_over_the_wavelength(lens: KnownLens) -> None:
    first, f_stop, height = first_order(lens.prescription), 2.0, 10.0
    sums = totals(seidel_sums(lens.prescription, f_stop, height))
    blue, red = (first_order(lens.prescription, line) for line in (F_LINE_NM, C_LINE_NM))
    # (but for what is of second order in the dispersion)
    # δl' = C_I over the square of the marginal ray's slope, δη' = C_II over that slope (Welford 1986, ch. 10)
    assert blue.back_focal_mm - red.back_focal_mm == pytest.approx(-sums["axial_colour"] * (2 * f_stop) ** 2, rel=0.08)
    heights = [
        landing_of_chief(lens.prescription, 1e-3, line) / 1e-3 / first.focal_length_mm
        for line in (F_LINE_NM, C_LINE_NM)
    ]
    assert (heights[0] - heights[1]) * height == pytest.approx(-sums["lateral_colour"] * 2 * f_stop, rel=0.08)
