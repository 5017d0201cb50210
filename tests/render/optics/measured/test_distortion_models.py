"""Calibrated distortion: the formulas of OpenCV and OpenTrackIO, their files, and what a data sheet keeps of them."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from render.errors import InputError
from render.optics.measured.brown_conrady import BrownConrady
from render.optics.measured.calibration_file import Calibration, parse_calibration
from render.optics.measured.radial_distortion import fit_radial

MATRIX = [[2000.0, 0, 959.5], [0, 2000.0, 539.5], [0, 0, 1]]
TERMS = [-0.1, 0.02, 0.0005, -0.0002, 0.001]
OPENCV = {"camera_matrix": MATRIX, "dist_coeffs": [TERMS], "image_width": 1920, "image_height": 1080}
YAML = """%YAML:1.0
---
calibration_time: "Fri 27 Nov 2026"
image_width: 1920
image_height: 1080
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 2000., 0., 959.5, 0., 2000., 539.5, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -0.1, 0.02, 0.0005, -0.0002, 0.001 ]
"""
TRACKED = {
    "protocol": {"name": "OpenTrackIO", "version": [1, 0, 1]},
    "static": {"camera": {"activeSensorPhysicalDimensions": {"width": 36.0, "height": 24.0}}},
    "lens": {
        "pinholeFocalLength": 40.0,
        "distortion": [{"model": "Brown-Conrady D-U", "radial": [2e-5, 3e-6, 1e-8, 0, 0, 0], "tangential": [0, 0]}],
    },
}


def parse(content: object, name: str = "cal.json") -> Calibration:
    return parse_calibration((content if isinstance(content, str) else json.dumps(content)).encode(), name)


def test_opencvs_formula_term_by_term() -> None:
    """At a point, as in OpenCV's documentation of calib3d."""
    k1, k2, p1, p2, k3, k4, k5, k6 = 0.1, -0.2, 0.01, -0.02, 0.3, 0.05, -0.06, 0.07
    x, y = 0.3, -0.4
    model = BrownConrady.from_opencv((k1, k2, p1, p2, k3, k4, k5, k6))
    r2 = 0.25
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    expected = (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x**2),
        y * radial + p1 * (r2 + 2 * y**2) + 2 * p2 * x * y,
    )
    assert model.apply(np.array([x, y])) == pytest.approx(expected)


def test_opentrackios_odd_terms_are_over_and_even_ones_under() -> None:
    """OpenLensIO 1.0.1, section 4.1: R = (1 + k1r² + k3r⁴ + k5r⁶) / (1 + k2r² + k4r⁴ + k6r⁶), r in millimetres."""
    k = (1e-4, 2e-5, 3e-7, 4e-8, 5e-10, 6e-11)
    model = BrownConrady.from_opentrackio(k, ())
    r2 = 15.0**2
    over, under = 1 + k[0] * r2 + k[2] * r2**2 + k[4] * r2**3, 1 + k[1] * r2 + k[3] * r2**2 + k[5] * r2**3
    assert model.apply(np.array([9.0, 12.0])) == pytest.approx(np.array([9.0, 12.0]) * over / under)


@pytest.mark.parametrize(("content", "name"), [(OPENCV, "cal.json"), (YAML, "cal.yaml")])
def test_opencvs_files_are_one_calibration(content: object, name: str) -> None:
    found = parse(content, name)
    assert found.model == BrownConrady((-0.1, 0.02, 0.001), (0, 0, 0), (0.0005, -0.0002))
    assert found.pinhole_mm((36, 20.25)) == pytest.approx(37.5)
    flat = {
        "fx": 2000,
        "fy": 2000,
        "cx": 959.5,
        "cy": 539.5,
        "k1": -0.1,
        "k2": 0.02,
        "p1": 0.0005,
        "p2": -0.0002,
        "k3": 0.001,
    }
    assert parse(flat).model == found.model


def test_a_sheet_has_the_radial_part_of_a_calibration() -> None:
    """OpenCV's distortion over the undistorted radius, inverted, is the sheet's over the height in the picture."""
    calibration = parse({**OPENCV, "dist_coeffs": [-0.1, 0.02, 0, 0, 0.001]})
    found = fit_radial(*calibration.pairs_mm(37.5, 20.0), "cal")
    undistorted = np.linspace(0.01, 0.5, 40)
    shown = undistorted * (1 - 0.1 * undistorted**2 + 0.02 * undistorted**4 + 0.001 * undistorted**6)
    expected = shown / undistorted - 1
    within = shown * 37.5 <= 20
    at = np.interp(shown[within] * 37.5, found.heights_mm, found.distortion)
    assert at == pytest.approx(expected[within], abs=2e-5)
    assert found.rms_mm < 1e-4
    assert found.centre_scale == pytest.approx(1, abs=1e-5)


def test_decentring_is_what_a_sheet_leaves() -> None:
    calibration = parse({**OPENCV, "dist_coeffs": [0, 0, 0.001, 0]})
    found = fit_radial(*calibration.pairs_mm(37.5, 20.0), "cal")
    slope = 20 / 37.5
    assert found.worst_mm == pytest.approx(37.5 * 3 * 0.001 * slope**2, rel=0.2)
    assert np.abs(found.distortion).max() < 2e-3


@pytest.mark.parametrize("distorts", [False, True])
def test_both_directions_of_opentrackio_are_read(distorts: bool) -> None:
    """A barrel as U-D, and the pincushion that undoes it as D-U, are nearly one lens."""
    entry = {"model": "Brown-Conrady U-D" if distorts else "Brown-Conrady D-U", "radial": [-1e-4 if distorts else 1e-4]}
    calibration = parse({**TRACKED, "lens": {"pinholeFocalLength": 40.0, "distortion": [entry]}})
    found = fit_radial(*calibration.pairs_mm(40.0, 10.0), "cal")
    assert found.distortion[-1] == pytest.approx(-0.01, abs=5e-4)
    assert calibration.pinhole_mm((36, 24)) == 40
    assert calibration.gate_mm == (36, 24)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        ("", "neither JSON nor YAML|neither OpenCV"),
        ("[" * 5000, "nested too deep"),
        ("a: &a {b: 1}\nc: &c {<<: [*a, *a]}\nd: {<<: [*c, *c]}\n", "nested too deep"),
        ("a: &a [*a, *a]", "no camera_matrix"),
        ("!!python/object/apply:os.system ['true']", "neither JSON nor YAML"),
        ("a: !!timestamp abc", "neither JSON nor YAML"),
        ("a: !!bool foo", "neither JSON nor YAML"),
        ("a: !!int ''", "neither JSON nor YAML"),
        ({"camera_matrix": MATRIX}, "no distortion_coefficients"),
        ({**OPENCV, "dist_coeffs": [1, 2]}, "2 distortion coefficients, expected 4, 5 or 8"),
        ({**OPENCV, "dist_coeffs": [0] * 11 + [1]}, "thin-prism"),
        ({**OPENCV, "dist_coeffs": [float("nan"), 0, 0, 0]}, "must be a number"),
        ({**OPENCV, "dist_coeffs": [1e300, 0, 0, 0]}, "must be a number"),
        ({**OPENCV, "camera_matrix": [[0, 0, 1], [0, 1, 1], [0, 0, 1]]}, "focal lengths must be above 0"),
        ({**OPENCV, "camera_matrix": [1, 2, 3]}, "has 3 numbers, expected 9"),
        ({**OPENCV, "image_width": 1e300}, "pixels, which no picture is|must be a number"),
        ({**TRACKED, "lens": {"distortion": [{"model": "3DE4", "radial": [1]}]}}, "no distortion of the models"),
        ({**TRACKED, "lens": {"distortion": [{"radial": "k"}]}}, "must be a list of numbers"),
    ],
)
def test_what_is_no_calibration_is_one_error(content: object, words: str) -> None:
    with pytest.raises(InputError, match=words) as raised:
        parse(content)
    assert "\n" not in raised.value.detail


@pytest.mark.parametrize("terms", [[-0.9, 0, 0, 0], [0, 0, 0, 0, -5], [0, 0, 0, 0, 0, 9, 0, 0]])
def test_a_distortion_that_folds_the_picture_is_refused(terms: list[float]) -> None:
    calibration = parse({**OPENCV, "dist_coeffs": terms})
    with pytest.raises(InputError, match="folds the picture"):
        calibration.pairs_mm(37.5, 30.0)
    back = replace(calibration, model=replace(calibration.model, distorts=False, over=(-3.0, 0, 0)))
    with pytest.raises(InputError, match="folds the picture"):
        back.pairs_mm(37.5, 30.0)
