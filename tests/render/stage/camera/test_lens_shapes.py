"""Tori, phases and polygons of a camera's lens in USD."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pxr import Usd, UsdGeom

from render.errors import CameraError
from render.model.camera import Camera
from render.model.lens import Across, Glass, Outline, Prescription, Surface
from render.optics.prescription.outlines import polygon, spider
from render.stage import read_camera
from render.stage.camera.lens_data import lens_data
from render.stage.camera.lenses import make_lens
from tests.render.kits.stages import new_stage
from usd_schemas import LensCamera, mount_lens

CYLINDERS = Prescription(
    (
        Surface(0.0, 4.0, Glass(1.6, 60.0), 10.0, across=Across(-90.0)),
        Surface(0.0, 30.0, semi_diameter_mm=10.0, across=Across(90.0, -0.5)),
        Surface(40.0, 5.0, Glass(1.6, 60.0), 10.0, conic=-0.3),
        Surface(-40.0, 30.0, semi_diameter_mm=10.0),
    ),
    f_stop=4.0,
    name="cylinders",
)


@pytest.fixture
def stage() -> Usd.Stage:
    return new_stage(0.01)


@pytest.fixture
def camera(stage: Usd.Stage) -> LensCamera:
    return LensCamera(UsdGeom.Camera.Define(stage, "/cam").GetPrim())


def _read(stage: Usd.Stage) -> Camera:
    return read_camera(stage, "/cam", 1.0)


def test_tori_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    front = replace(CYLINDERS.surfaces[2], aspheric=(1e-6,), across=Across(70.0, torus="upright"))
    back = replace(CYLINDERS.surfaces[3], aspheric=(1e-6,), across=Across(-40.0, 0.0, "across"))
    lens = replace(CYLINDERS, surfaces=(*CYLINDERS.surfaces[:2], front, back))
    mount_lens(camera, lens_data(lens))
    assert _read(stage).lens.prescription == lens


def test_polygons_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    polygons = polygon([(0.0, 6.0), (4.0, -5.0), (-4.0, -5.0)]), spider(0.5, 3, 9.0)
    front = replace(CYLINDERS.surfaces[2], opening=polygons[0], obscuration=polygons[1])
    back = replace(CYLINDERS.surfaces[3], opening=Outline("rectangle", (3.0, 2.0), (0.5, 0.0)), obscuration=polygons[1])
    lens = replace(CYLINDERS, surfaces=(*CYLINDERS.surfaces[:2], front, back))
    mount_lens(camera, lens_data(lens))
    assert _read(stage).lens.prescription == lens


def test_phases_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    front = replace(CYLINDERS.surfaces[2], phase=(-4.0, 0.0, 1e-5))
    lens = replace(CYLINDERS, surfaces=(*CYLINDERS.surfaces[:2], front, CYLINDERS.surfaces[3]))
    mount_lens(camera, lens_data(lens))
    assert _read(stage).lens.prescription == lens


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        (((0.0, 0.0), (1.0, 0.0), (0.0, 1.0)), "openingCorners .* closed polygons, .* got an open one"),
        (((0.0, 0.0), (1.0, 0.0), (0.0, 0.0)), "openingCorners .* at least 3 for each polygon, got 2"),
        ((), "openingCorners .* 1 polygons, one for each shape that is .*, got 0"),
    ],
)
def test_faulty_polygons_are_refused(corners: tuple[tuple[float, float], ...], message: str) -> None:
    data = lens_data(CYLINDERS)
    rows = replace(data.prescription, opening_shape=("", "", "polygon", ""), opening_corners=corners)
    with pytest.raises(CameraError, match=message):
        make_lens(replace(data, prescription=rows), "/cam")
