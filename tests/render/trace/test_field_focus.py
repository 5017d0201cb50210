"""One circle of confusion: what readouts say of a lens with a curved field, what points ask of it, and what pictures measure."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import spheres_over_checkerboard
from render.model.camera import Camera
from render.model.lens import AIR, AberrationScales, Glass, Lens, Prescription, SeidelErrors, Surface
from render.optics.view import PinholeView
from render.shot import Shot
from render.shot.focus.focused_camera import focus_without_points
from render.shot.lens.lens_choice import choose_lens
from render.trace.field_focus import field_focus, field_shifts_w
from tests.render.kits.lenses import DOUBLE_GAUSS, PLANAR
from tests.render.kits.table_shot import CAMERA, ON_TABLE, on_table, write_table

SCENE, CAMERA_OF_SCENE = spheres_over_checkerboard()
WIDTH, HEIGHT = 800, 533
SINGLET = Prescription((Surface(50.0, 5.0, Glass(1.5168, 64.17), 12.0), Surface(-50.0, 0.0, AIR, 12.0)), name="singlet")
SEIDEL = SeidelErrors(w040=2.0, w131=3.0, w222=3.0, w220=-20.0, axial_color_mm=0.1)
PLACES = ON_TABLE | {"near": (0.1, 0.0, 0.3)}  # in the picture of 50 mm
LENSES = {
    "seidel": Camera(np.eye(4), 50.0, f_stop=2.0, lens=Lens("seidel", seidel=SEIDEL)),
    "drawn power": Camera(np.eye(4), 50.0, f_stop=2.0, lens=Lens(pupil_power=(1.0, 1.0, 1.02), expressive_blend=1.0)),
    "singlet": Camera(np.eye(4), 50.0, f_stop=4.0, lens=Lens("spherical", prescription=SINGLET)),
    "double gauss": Camera(
        np.eye(4), 50.36, f_stop=2.03, lens=Lens("prescription", prescription=DOUBLE_GAUSS.prescription)
    ),
    "planar": Camera(np.eye(4), 53.0, f_stop=2.0, lens=Lens("prescription", prescription=PLANAR.prescription)),
    "scaled": Camera(
        np.eye(4),
        50.36,
        f_stop=2.8,
        lens=Lens(
            "prescription",
            prescription=DOUBLE_GAUSS.prescription,
            scales=AberrationScales(field_curvature=0.5, astigmatism=2.0, chromatic=0.5),
        ),
    ),
}


@pytest.mark.parametrize("distance_m", [0.0, 1.1])
@pytest.mark.parametrize("name", LENSES)
def test_readouts_have_the_measured_focus_all_over_the_picture(
    renderer: FrameRenderer, name: str, distance_m: float
) -> None:
    camera = replace(
        LENSES[name],
        world_from_camera=CAMERA_OF_SCENE.world_from_camera,
        vertical_aperture_mm=24.0,
        focus_distance_m=distance_m,
    )
    aovs = renderer.render(SCENE, camera, FrameSettings(120, 80, rays=1, aovs=("color", "depth", "coc"))).aovs
    view = PinholeView.from_camera(camera, 120, 80)
    x, y = np.meshgrid(np.arange(120) + 0.5, np.arange(80) + 0.5)
    field = field_focus(camera)
    assert field is not None
    places = np.hypot((x - view.cx) / view.fx, (y - view.cy) / view.fy)
    seen = np.interp(places, field.heights, field.seen) / places
    slopes = np.stack([(x - view.cx) / view.fx * seen, -(y - view.cy) / view.fy * seen], axis=-1)
    depths_m = aovs["depth"].astype(np.float64)
    told_mm = focus_without_points(camera).cocs_mm(depths_m.ravel(), slopes.reshape(-1, 2)).reshape(80, 120)
    measured_mm = 2 * np.abs(aovs["coc"]) * 36 / 120
    a_pixel_mm = 36 / WIDTH
    off = np.abs(told_mm - measured_mm)
    assert np.percentile(off, 95) < 0.2 * a_pixel_mm + 0.03 * np.median(measured_mm)


def test_a_shift_does_not_jump_as_the_lens_is_focused_or_zoomed() -> None:
    camera = replace(LENSES["double gauss"], vertical_aperture_mm=24.0)
    corner = np.array([[0.3, 0.1]])
    w = np.linspace(0.0, 1.5, 61)
    shifts = np.array([field_shifts_w(camera, corner, np.array([each]))[0] for each in w])
    assert np.ptp(shifts) > 0
    assert np.abs(np.diff(shifts)).max() < 0.1 * np.ptp(shifts)
    zoomed = [
        float(field_shifts_w(replace(camera, focal_length_mm=f), corner, np.array([0.5]))[0]) for f in (50.4, 50.6)
    ]
    assert zoomed[0] == pytest.approx(zoomed[1], rel=0.02)


def test_a_thin_lens_and_a_pinhole_have_no_shift() -> None:
    camera = Camera(np.eye(4), f_stop=2.0, focus_distance_m=2.0)
    assert field_focus(camera) is None
    assert field_focus(replace(LENSES["double gauss"], f_stop=0.0)) is None
    assert field_shifts_w(camera, np.full((2, 2), 0.2), np.ones(2)).tolist() == [0.0, 0.0]


@pytest.fixture
def shot(tmp_path: Path) -> Shot:
    made = Shot.open(write_table(tmp_path / "table.usda"))
    made.camera.mount_lens(CAMERA, choose_lens("double_gauss_50"))
    return made


def coc_at(aovs: dict[str, np.ndarray], screen: tuple[float, float] | None) -> float:  # type: ignore[type-arg]
    """Radius in pixels that is measured at a place of the picture."""
    assert screen is not None
    row, column = screen[1] * HEIGHT - 0.5, screen[0] * WIDTH - 0.5
    return float(map_coordinates(aovs["coc"].astype(np.float64), [[row], [column]], order=1)[0])


@pytest.mark.parametrize(
    ("mode", "names"),
    [("points", ["left"]), ("tiltPlane", ["near", "left", "far"]), ("surface", ["near", "left", "far"])],
)
def test_a_focused_point_is_sharp_in_readout_and_picture(
    shot: Shot, renderer: FrameRenderer, mode: str, names: list[str]
) -> None:
    for name in names:
        shot.focus.add_point(CAMERA, name, on_table(name, PLACES[name]))
    shot.focus.set(CAMERA, mode=mode, max_angle_deg=40.0)
    camera = shot.camera_at(CAMERA, 1, WIDTH, HEIGHT)
    settings = FrameSettings(WIDTH, HEIGHT, rays=1, aovs=("color", "coc"))
    aovs = renderer.render(shot.scene_at(1), camera, settings).aovs
    for placed in shot.focus.points(CAMERA, 1):
        assert placed.state == "used"
        told_px = placed.coc_mm / 2 * WIDTH / 36
        assert told_px < 0.15, placed.point.name
        assert abs(coc_at(aovs, placed.screen)) < 0.3, placed.point.name


def test_a_point_off_the_axis_is_focused_by_the_curved_field(shot: Shot) -> None:
    """By hand on its own depth it is soft; by its point it is sharp, and the plane on the axis lies elsewhere."""
    shot.focus.add_point(CAMERA, "left", on_table("left", ON_TABLE["left"]))
    shot.focus.set(CAMERA, mode="points")
    by_point = shot.focus.points(CAMERA, 1)[0]
    distance_m = shot.focus.read(CAMERA, 1).focus_distance_m
    assert abs(1 / distance_m - 1 / by_point.depth_m) > 0.005
    shot.focus.set(CAMERA, mode="manual")
    shot.camera.set(CAMERA, focus_distance_m=by_point.depth_m)
    by_hand = shot.focus.points(CAMERA, 1)[0]
    assert by_point.coc_mm < 0.1 * by_hand.coc_mm
    assert math.isfinite(distance_m)
