"""Lenses with cylinders on the device, and their pictures, against float64 rays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

from render.frame import FrameRenderer, FrameSettings
from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import AberrationScales, Across, Glass, Lens, Prescription, Surface
from render.optics.glass import D_LINE_NM
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.mounting import mount_lens
from render.optics.prescription.stop_rays import StopRays, rays_from_film
from render.stage.camera.lenses import make_lens
from render.trace.grid_table import make_asymmetric_table
from render.trace.lens_table import GridTable
from render.trace.surface_tracer import SurfaceTracer
from tests.render.kits.lens_pictures import glowing_point, spot_size
from usd_schemas import library_lens

pytestmark = pytest.mark.gl

GLASS = Glass(1.6, 60.0)
LENS = Prescription(
    (
        Surface(90.0, 4.0, GLASS, 14.0, across=Across(-150.0, 0.5)),
        Surface(0.0, 12.0, semi_diameter_mm=14.0, across=Across(-70.0, -1.2), aspheric=(2e-6,)),
        Surface(0.0, 6.0, semi_diameter_mm=5.0, is_stop=True),
        Surface(60.0, 5.0, GLASS, 14.0),
        Surface(-60.0, 0.0, semi_diameter_mm=14.0),
    ),
    f_stop=5.6,
    name="biconic",
)


TORI = replace(
    LENS,
    surfaces=(
        replace(LENS.surfaces[0], across=Across(-150.0, torus="upright"), conic=-0.8, aspheric=(3e-6,), odd=(-1e-5,)),
        replace(LENS.surfaces[1], across=Across(-70.0, -1.2, torus="across")),
        LENS.surfaces[2],
        replace(LENS.surfaces[3], across=Across(80.0)),
        LENS.surfaces[4],
    ),
)


@pytest.mark.parametrize("made", [LENS, TORI], ids=["biconic", "tori"])
def test_the_device_traces_cylinders_as_float64_does(made: Prescription) -> None:
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        lens = focus_lens(complete_prescription(made, image_height_mm=12.0), 4.0, 5.6)
        line = np.linspace(-10, 10, 5)
        films = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
        angle = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        stops = np.concatenate([[[0.0, 0.0]], np.stack([np.cos(angle), np.sin(angle)], axis=1) * 0.97])
        film, stop = np.repeat(films, len(stops), axis=0), np.tile(stops, (len(films), 1))
        found = tracer.trace(lens, film, stop * lens.stop_radius_mm, (587.5618,))
    finally:
        graphics.close()
    true = rays_from_film(lens, film, stop)
    assert true.passed.mean() > 0.9
    both = true.passed & found.passed[0]
    assert (true.passed == found.passed[0]).mean() > 0.99
    np.testing.assert_allclose(found.slope[0][both], true.slope[both], atol=3e-6)
    np.testing.assert_allclose(found.pupil_mm[0][both], true.pupil_mm[both], atol=2e-4)
    np.testing.assert_allclose(found.front[0][both], true.front[both], atol=2e-4)


SQUEEZE, GATE_MM, F_STOP = 2.0, (43.9, 18.6), 2.8
FOCUS_M = 2.0
PLACES = ((0.0, 0.0), (0.27, 0.0), (0.0, 0.11), (0.25, 0.1), (-0.17, 0.06))  # slopes, between the table's fields


@pytest.fixture(scope="module")
def anamorphic() -> Lens:
    return make_lens(library_lens("anamorphic_75_2x").lens, "/cam")


def camera_with(lens: Lens, focus_m: float) -> Camera:
    return Camera(np.eye(4), 75.0, *GATE_MM, f_stop=F_STOP, focus_distance_m=focus_m, near_m=0.1, lens=lens)


def stop_points(count: int) -> DoubleArray:
    """Points that fill the unit disc evenly."""
    line = np.linspace(-1, 1, count)
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    return points[np.hypot(*points.T) <= 0.999]


def interpolated(table: GridTable, slope: tuple[float, float], stops: DoubleArray) -> DoubleArray:
    """Rays ``(n, 4)`` at a field, y down, as ``lens/lens_rays.glsl`` reads them; NaN for blocked ones."""
    mirror = np.where(np.asarray(slope) < 0, -1.0, 1.0)
    last = np.asarray(table.fields) - 1
    at = np.minimum(np.abs(slope) / np.asarray(table.last_slope) * last, last)
    low = np.minimum(at.astype(int), last - 1)
    part, side = at - low, table.rays.shape[2]
    values = np.concatenate([table.rays[0], table.light[0]], axis=-1).astype(np.float64)
    place = np.clip((stops * mirror + 1) / 2 * (side - 1), 0, side - 1)
    total = np.zeros((len(stops), 6))
    for step in np.ndindex(2, 2):
        share = np.prod(np.where(step, part, 1 - part))
        field = values[(low[1] + step[1]) * table.fields[0] + low[0] + step[0]]
        total += share * np.stack(
            [map_coordinates(field[..., k], place[:, ::-1].T, order=1) for k in range(6)], axis=-1
        )
    return np.where(total[:, 5:] <= 0, total[:, :4] * np.tile(mirror, 2), np.nan)


def true_rays(lens: FocusedLens, slope: tuple[float, float], stops: DoubleArray) -> StopRays:
    """Float64 rays of a place of the picture, x right and y up."""
    film = -np.array(slope) * [lens.image_scale_mm / SQUEEZE, lens.image_scale_mm]
    return rays_from_film(lens, np.tile(film, (len(stops), 1)), stops)


def test_the_table_is_that_of_float64_rays(anamorphic: Lens) -> None:
    """At five places between its fields: directions within 4 µm on the film, pupil points within 0.3 % of the pupil."""
    graphics = GraphicsContext()
    graphics.make_current()
    try:
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        lens = mount_lens(camera_with(anamorphic, FOCUS_M))
        edges = GATE_MM[0] / 150, GATE_MM[1] / 150
        table = make_asymmetric_table(tracer, lens, SQUEEZE, edges, 1 / FOCUS_M, (D_LINE_NM,), AberrationScales())
    finally:
        graphics.close()
    stops = stop_points(21) * 0.93  # rims cut between the points of the grid
    for slope in PLACES:
        true = true_rays(lens, slope, stops)
        found = interpolated(table, (slope[0], -slope[1]), stops * [1.0, -1.0]) * [1.0, -1.0, 1.0, -1.0]
        is_open = true.passed & (np.maximum(true.front, true.rear) < -0.02)
        assert is_open.sum() > 200
        seen = true.slope + true.pupil_mm / 1000 / FOCUS_M - slope
        off_um = (found[:, :2] - seen)[is_open] * lens.image_scale_mm * 1000 * [1 / SQUEEZE, 1.0]
        assert np.abs(off_um).max() < 4.0
        off_pupil = (found[:, 2:] * 1000 - true.pupil_mm)[is_open] / lens.entrance_pupil_radius_mm
        assert np.abs(off_pupil).max() < 3e-3


def traced_spot(lens: FocusedLens, slope: tuple[float, float], depth_m: float) -> tuple[DoubleArray, DoubleArray]:
    """Middle and standard deviations, as slopes of the picture, of the image of a point at a slope and a depth, by float64.

    The rays that a place of the picture sees are traced back; the place moves until the ray meets the point.
    """
    stops = stop_points(41)
    seen = np.tile(slope, (len(stops), 1)).astype(np.float64)
    for _ in range(12):
        film = -seen * [lens.image_scale_mm / SQUEEZE, lens.image_scale_mm]
        rays = rays_from_film(lens, film, stops)
        seen = seen + np.array(slope) - (rays.slope + rays.pupil_mm / 1000 / depth_m)
    is_open = rays.passed & (np.maximum(rays.front, rays.rear) <= 0)
    spot = seen[is_open]
    return spot.mean(axis=0), spot.std(axis=0)


@pytest.mark.parametrize("slope", PLACES)
def test_rendered_bokeh_is_that_of_float64_rays(
    renderer: FrameRenderer, anamorphic: Lens, slope: tuple[float, float]
) -> None:
    """A far light out of focus: its place in the stretched picture, and its size both ways."""
    camera, size = camera_with(anamorphic, 1.2), (472, 200)
    picture = renderer.render(
        glowing_point(*slope, 40.0, 0.04), camera, FrameSettings(*size, rays=256, wavelengths=1)
    ).color
    x, y, across, upright = spot_size(picture)
    middle, deviation = traced_spot(mount_lens(camera), slope, 40.0)
    px = 75.0 * size[0] / GATE_MM[0]
    assert (x - size[0] / 2) / px == pytest.approx(middle[0], abs=0.6 / px)
    assert -(y - size[1] / 2) / px == pytest.approx(middle[1], abs=0.6 / px)
    assert across / px == pytest.approx(deviation[0], rel=0.03)
    assert upright / px == pytest.approx(deviation[1], rel=0.03)


def test_bokeh_is_oval_and_the_rims_cut_it_at_the_sides(anamorphic: Lens) -> None:
    lens = mount_lens(camera_with(anamorphic, FOCUS_M))
    middle, side = (traced_spot(lens, slope, 40.0)[1] for slope in ((0.0, 0.0), (0.27, 0.0)))
    assert 1.6 < middle[1] / middle[0] < 2.1
    assert side[0] < 0.97 * middle[0]
    assert side[1] == pytest.approx(middle[1], rel=0.1)


@pytest.mark.parametrize("focus_m", [1.2, 5.0])
def test_the_picture_breathes_as_the_squeeze_does(anamorphic: Lens, focus_m: float) -> None:
    """Objects in focus are as much wider in the stretched picture as the squeeze has fallen."""
    lens = mount_lens(camera_with(anamorphic, focus_m))
    small = 0.01
    wide, high = traced_spot(lens, (small, 0.0), focus_m)[0][0], traced_spot(lens, (0.0, small), focus_m)[0][1]
    assert wide / high == pytest.approx(SQUEEZE / lens.squeeze, rel=3e-3)
    assert lens.squeeze < SQUEEZE * (0.9 if focus_m < 2 else 0.98)


def test_a_scattered_layer_is_squeezed_once(renderer: FrameRenderer, anamorphic: Lens) -> None:
    """The engine that scatters takes the table's own rays: it does not squeeze them once more."""
    camera = camera_with(anamorphic, 1.2)
    settings = FrameSettings(472, 200, rays=64, wavelengths=1)
    one, other = (
        spot_size(renderer.render(glowing_point(0.0, 0.0, 40.0, 0.04), camera, replace(settings, engine=engine)).color)
        for engine in ("lens", "scatter")
    )
    assert other[2:] == pytest.approx(one[2:], rel=0.1)
