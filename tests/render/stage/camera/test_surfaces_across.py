"""Surfaces of a lens that are not round go into USD and come back: cylinders, tori, odd powers, openings and obscurations."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pxr import Usd, UsdGeom

from render.errors import CameraError, InputError
from render.model.camera import Camera
from render.model.lens import Across, Glass, Outline, Prescription, Surface
from render.optics.prescription.meridians import turned
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.stop_placement import with_stop
from render.stage import read_camera
from render.stage.camera.lens_data import lens_data
from render.stage.camera.lenses import make_lens
from tests.render.kits.stages import new_stage
from usd_schemas import (
    LensCamera,
    LensData,
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


CYLINDERS = Prescription(
    (
        Surface(0.0, 4.0, Glass(1.6, 60.0), 10.0, across=Across(-90.0)),
        Surface(0.0, 30.0, semi_diameter_mm=10.0, across=Across(90.0, -0.5)),
        Surface(40.0, 5.0, Glass(1.6, 60.0), 10.0, conic=-0.3),
        Surface(-40.0, 30.0, semi_diameter_mm=10.0),
    ),
    focus_group=(2, 3),
    f_stop=4.0,
    name="cylinders",
    focus_group_across=(0, 0),
)


def test_cylinders_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    mount_lens(camera, lens_data(CYLINDERS))
    assert _read(stage).lens.prescription == CYLINDERS
    own, across = (first_order(with_stop(part)).focal_length_mm for part in (CYLINDERS, turned(CYLINDERS)))
    assert _read(stage).lens.squeeze == pytest.approx(own / across, abs=0.01)


def test_odd_powers_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    front = replace(CYLINDERS.surfaces[2], odd=(1e-5, 0.0, -2e-9), aspheric=(1e-6,))
    lens = replace(CYLINDERS, surfaces=(*CYLINDERS.surfaces[:2], front, CYLINDERS.surfaces[3]))
    mount_lens(camera, lens_data(lens))
    assert _read(stage).lens.prescription == lens


def test_odd_powers_beyond_the_schema_are_refused() -> None:
    lens = replace(CYLINDERS, surfaces=(replace(CYLINDERS.surfaces[0], odd=(0.0,) * 9 + (1e-30,)),))
    with pytest.raises(InputError, match=r"a term of r\^21, USD has them up to r\^20"):
        lens_data(lens)


def test_a_lens_of_spheres_has_no_arrays_across() -> None:
    plain = replace(CYLINDERS, surfaces=tuple(replace(surface, across=None) for surface in CYLINDERS.surfaces))
    assert lens_data(plain).prescription.radius_across == lens_data(plain).prescription.conic_across == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"radius_across": (1.0,)}, "radiusAcross .* 4 entries"),
        ({"torus": ("bent", "", "", "")}, 'torus .* "upright", "across" or "", got "bent"'),
        ({"torus": ("upright",)}, "torus .* 4 entries"),
        ({"focus_group_across": (2, 9)}, "focusGroupAcross .* rising from 0 to 3, got \\(2, 9\\)"),
    ],
)
def test_faulty_cylinders_are_refused(change: dict[str, object], message: str) -> None:
    data = lens_data(CYLINDERS)
    with pytest.raises(CameraError, match=message):
        make_lens(replace(data, prescription=replace(data.prescription, **change)), "/cam")


OUTLINED = replace(
    CYLINDERS,
    surfaces=(
        CYLINDERS.surfaces[0],
        replace(CYLINDERS.surfaces[1], opening=Outline("rectangle", (6.0, 4.0), (0.5, -1.0))),
        replace(CYLINDERS.surfaces[2], obscuration=Outline("ellipse", (2.0, 3.0))),
        CYLINDERS.surfaces[3],
    ),
)


def test_openings_and_obscurations_are_written_and_read(stage: Usd.Stage, camera: LensCamera) -> None:
    mount_lens(camera, lens_data(OUTLINED))
    assert _read(stage).lens.prescription == OUTLINED
    assert _read(stage).lens.has_outlines
    assert lens_data(CYLINDERS).prescription.opening_shape == lens_data(CYLINDERS).prescription.obscuration_size == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"opening_shape": ("", "star", "", "")},
            'openingShape .* "ellipse", "rectangle", "polygon" or "", got "star"',
        ),
        ({"opening_shape": ("rectangle",)}, "openingShape .* 4 entries, .* got 1"),
        ({"opening_shape": ()}, "openingShape .* given with sizes or centres, got none"),
        ({"obscuration_size": ()}, "obscurationSize .* given with shapes, got none"),
        ({"opening_centre": ((0.0, 0.0),) * 3}, "openingCentre .* 4 entries, .* got 3"),
        ({"opening_size": ((float("nan"), 0.0),) * 4}, "openingSize .* a finite number, got nan"),
    ],
)
def test_faulty_outlines_are_refused(change: dict[str, object], message: str) -> None:
    data = lens_data(OUTLINED)
    with pytest.raises(CameraError, match=message):
        make_lens(replace(data, prescription=replace(data.prescription, **change)), "/cam")


def test_a_thick_lens_takes_no_outlines() -> None:
    surfaces = replace(SINGLET, opening_shape=("ellipse", ""), opening_size=((4.0, 4.0), (0.0, 0.0)))
    with pytest.raises(CameraError, match=r"obscurationShape .* left out for lens:model spherical"):
        make_lens(LensData(model="spherical", prescription=surfaces), "/cam")


def test_a_thick_lens_takes_no_cylinders() -> None:
    with pytest.raises(CameraError, match="left out for lens:model spherical"):
        make_lens(LensData(model="spherical", prescription=replace(SINGLET, radius_across=(0.0, 0.0))), "/cam")
