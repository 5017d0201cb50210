"""Surfaces with two curves in Zemax files."""

from __future__ import annotations

import numpy as np
import pytest

from render.errors import InputError
from render.model.lens import Across, Prescription
from render.optics.lens_files import parse_lens_file
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import focal_points, paraxial_system
from render.optics.prescription.surface_shape import sag_at
from tests.render.kits.surface_files import ZEMAX


def read(kind: str, curvature: float, conic: float = 0.0, unit: str = "MM", **parameters: float) -> Prescription:
    lines = "".join(f"  PARM {name[1:]} {value}\n" for name, value in parameters.items())
    text = ZEMAX.format(kind=kind, curvature=curvature, conic=conic, parameters=lines).replace(
        "UNIT MM", f"UNIT {unit}"
    )
    return parse_lens_file(text.encode(), "cylinders.zmx")


def test_a_biconic_has_its_radius_and_conic_in_x() -> None:
    lens = read("BICONICX", 0.02, -1.0, p1=80.0, p2=-0.5)
    assert (lens.surfaces[0].radius_mm, lens.surfaces[0].conic) == (50.0, -1.0)
    assert lens.surfaces[0].across == Across(80.0, -0.5)
    assert not lens.surfaces[1].across


def test_a_radius_of_0_in_x_is_none() -> None:
    assert read("BICONICX", 0.02).surfaces[0].across == Across(0.0, 0.0)


def test_lengths_are_in_the_files_unit() -> None:
    assert read("BICONICX", 0.2, unit="CM", p1=8.0, p2=-0.5).surfaces[0].across == Across(80.0, -0.5)


@pytest.mark.parametrize(
    ("curvature", "turn_mm", "across"), [(0.02, 0.0, Across(0.0)), (0.0, 40.0, Across(40.0)), (0.02, 50.0, None)]
)
def test_a_torus_that_is_a_cylinder_or_a_sphere_is_read(
    curvature: float, turn_mm: float, across: Across | None
) -> None:
    lens = read("TOROIDAL", curvature, p1=turn_mm)
    assert lens.surfaces[0].across == across


def test_a_torus_has_the_terms_of_its_curve() -> None:
    lens = read("TOROIDAL", 0.02, -1.0, p1=70.0, p3=1e-6, p4=-2e-9)
    front = lens.surfaces[0]
    assert (front.radius_mm, front.conic, front.across) == (50.0, -1.0, Across(70.0, 0.0, "upright"))
    assert front.aspheric == (1e-6, -2e-9)
    inches = read("TOROIDAL", 0.2, -1.0, "CM", p1=7.0, p3=1e-3).surfaces[0]
    assert inches.across == Across(70.0, 0.0, "upright")
    assert inches.aspheric == pytest.approx((1e-6,))


def test_a_term_of_y_squared_is_the_curvature_of_a_flat_curve() -> None:
    front = read("TOROIDAL", 0.0, p1=70.0, p2=0.01).surfaces[0]
    assert (front.radius_mm, front.conic, front.across) == (50.0, -1.0, Across(70.0, 0.0, "upright"))


def test_a_term_of_y_squared_on_a_curve_is_fitted_along_it() -> None:
    lens = read("TOROIDAL", 0.02, p1=70.0, p2=1e-4)
    y = np.linspace(-8, 8, 33)
    curve = 0.02 * y**2 / (1 + np.sqrt(1 - 0.0004 * y**2)) + 1e-4 * y**2
    points = np.stack([np.full(33, 3.0), y], axis=1)
    np.testing.assert_allclose(sag_at(lens.surfaces[0], points), 70 - np.sqrt((70 - curve) ** 2 - 9), atol=1e-9)
    assert "place of its term of r^2" in lens.notes[0]


def test_zernike_terms_of_a_torus_are_refused() -> None:
    text = ZEMAX.format(kind="TOROIDAL", curvature=0.02, conic=0, parameters="  PARM 1 70\n  XDAT 1 4\n")
    with pytest.raises(InputError, match=r"surface 1: Zernike terms \(XDAT 1\) of a torus are not supported"):
        parse_lens_file(text.encode(), "a.zmx")


def test_the_planes_of_a_biconic_have_its_curves() -> None:
    """Each plane's focal length is the one that the thick lens's equation gives."""
    lens = read("BICONICX", 0.02, p1=80.0)
    n = 1.5168
    for part, radius in ((lens, 50.0), (turned(lens), 80.0)):
        power = (n - 1) * (1 / radius + 0.02 - (n - 1) * 5 * 0.02 / (n * radius))
        assert focal_points(paraxial_system(part))[0] == pytest.approx(1 / power, rel=1e-5)


@pytest.mark.parametrize(
    ("kind", "parameters", "message"),
    [
        ("TOROIDAL", {"p1": 70.0, "p9": 1e-6}, "PARM 9 of a surface of TYPE TOROIDAL must be 0"),
        ("BICONICX", {"p1": 70.0, "p5": 1.0}, "PARM 5 of a surface of TYPE BICONICX must be 0"),
        ("BICONICX", {"p1": float("inf")}, "parameter"),
    ],
)
def test_other_surfaces_are_refused(kind: str, parameters: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        read(kind, 0.02, **parameters)


def test_a_plane_of_air_that_a_cylinder_bulges_through_is_left_out() -> None:
    text = ZEMAX.format(kind="TOROIDAL", curvature=0, conic=0, parameters="  PARM 1 -50\n")
    element = "SURF 0.{0}\n  TYPE STANDARD\n  CURV {1}\n  DISZ {2}\n{3}  DIAM 8\n"
    glass = "  GLAS N-BK7 0 0 1.5168 64.17\n"
    before = element.format(1, 0.02, 3, glass) + element.format(2, 0, 2, "") + element.format(3, 0, 0.02, "")
    lens = parse_lens_file(text.replace("SURF 1\n", before + "SURF 1\n").encode(), "cylinders.zmx")
    assert [surface.thickness_mm for surface in lens.surfaces[:3]] == pytest.approx([3, 2.02, 5])
    assert any("a plane of air, is cut by the glass beside it; it is left out" in note for note in lens.notes)
