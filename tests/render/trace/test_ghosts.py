"""Ghosts of bright sources, held against closed forms and against light that is traced ray by ray."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import moderngl
import numpy as np
import pytest

from render.errors import GraphicsError
from render.frame import FrameRenderer
from render.gl.compat import GL
from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import Glass, IrisShape, Prescription, Surface
from render.optics.flare.coating import reflectance
from render.optics.flare.ghost_sheets import Source, ghost_sheets
from render.optics.flare.ghosts import GhostPath, ghost_paths, trace_ghost
from render.optics.iris import transmission
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.paraxial import paraxial_system
from render.optics.spectrum import THREE_LINES, Spectrum, band_nm, spectrum
from render.optics.view import PinholeView
from render.trace.ghost_pass import GhostPass
from tests.render.kits.lenses import DOUBLE_GAUSS

N = 1.5
ROUND = transmission(IrisShape(), 512)
WHITE = np.ones(3)

pytestmark = pytest.mark.gl


@pytest.fixture
def ghost_pass(renderer: FrameRenderer) -> Iterator[GhostPass]:
    made = GhostPass(renderer.graphics.ctx)
    yield made
    made.release()


def singlet(f_stop: float, coating_nm: float = 0.0) -> FocusedLens:
    """A biconvex lens of 50 mm right behind its stop."""
    glass = Glass(N)
    surfaces = (
        Surface(0.0, 1.0, semi_diameter_mm=8.0, is_stop=True),
        Surface(50.0, 4.0, glass, 12.0, coating_nm=coating_nm),
        Surface(-50.0, 0.0, semi_diameter_mm=12.0, coating_nm=coating_nm),
    )
    return focus_lens(complete_prescription(Prescription(surfaces, name="a singlet")), np.inf, f_stop)


def double_gauss(f_stop: float) -> FocusedLens:
    return focus_lens(complete_prescription(DOUBLE_GAUSS.prescription), np.inf, f_stop)


def view_of(lens: FocusedLens, width: int, height: int, gate_mm: float = 36.0) -> PinholeView:
    """Pixels of a picture whose gate is that wide."""
    f_px = lens.image_scale_mm / gate_mm * width
    return PinholeView(width, height, f_px, f_px, width / 2, height / 2, 0.1, np.inf, np.eye(4))


def energy(picture: FloatArray, view: PinholeView) -> DoubleArray:
    """Return the light in a picture, relative to a source of irradiance 1."""
    return np.asarray(picture.sum(axis=(0, 1), dtype=np.float64) / (view.fx * view.fy))


def test_every_pair_of_refracting_surfaces_makes_a_ghost() -> None:
    prescription = complete_prescription(DOUBLE_GAUSS.prescription)
    mirrors = len(prescription.surfaces) - 1  # all but the stop: the cemented surfaces reflect too
    paths = ghost_paths(prescription)
    assert len(paths) == len(set(paths)) == mirrors * (mirrors - 1) // 2
    assert all(path.front < path.rear for path in paths)
    same = replace(prescription.surfaces[3], glass=prescription.surfaces[2].glass)
    alike = replace(prescription, surfaces=(*prescription.surfaces[:3], same, *prescription.surfaces[4:]))
    assert len(ghost_paths(alike)) == (mirrors - 1) * (mirrors - 2) // 2


@pytest.mark.parametrize("path", [GhostPath(2, 1), GhostPath(4, 0), GhostPath(8, 3), GhostPath(10, 9)])
def test_near_the_axis_a_ghost_lies_where_first_order_optics_has_it(path: GhostPath) -> None:
    lens = double_gauss(8.0)
    height, slope = 1e-4, 2e-5
    direction = np.array([slope, 0.0, 1.0]) / np.hypot(slope, 1.0)
    rays = trace_ghost(lens, path, np.array([[height, 0.0, lens.vertices_mm[0]]]), direction[None])
    system = paraxial_system(lens.prescription, vertices_mm=lens.vertices_mm)
    c, n = system.curvatures, system.indices
    there = [(i, n[i], n[i + 1]) for i in range(path.rear)] + [(path.rear, 0.0, 0.0)]
    back = [(i, n[i + 1], n[i]) for i in range(path.rear - 1, path.front, -1)] + [(path.front, 0.0, 0.0)]
    on = [(i, n[i], n[i + 1]) for i in range(path.front + 1, len(system.powers))]
    y, u, z = height, slope, float(lens.vertices_mm[0])
    for i, before, behind in [*there, *back, *on]:
        y, z = y + u * (system.vertices_mm[i] - z), float(system.vertices_mm[i])
        # a mirror of curvature c turns the slope dy/dz by its normal's; glass bends it as Snell's law has it near the axis
        u = (before * u - (behind - before) * c[i] * y) / behind if behind else -u - 2 * c[i] * y
    y += u * (lens.film_mm - z)
    assert rays.film_mm[0, 0] == pytest.approx(y, rel=1e-5)


@pytest.mark.parametrize("side", [24, 200])  # small ghosts are spread over pixels, large ones are triangles
def test_a_ghosts_energy_is_the_product_of_the_reflectances(ghost_pass: GhostPass, side: int) -> None:
    lens = singlet(22.0)
    view = view_of(lens, side, side, 60.0)
    picture = ghost_pass.draw(ghost_sheets(lens, [Source((0.0, 0.0), WHITE)], THREE_LINES), view, ROUND)
    assert energy(picture, view) == pytest.approx(((N - 1) / (N + 1)) ** 4, rel=0.01)
    assert not picture[0].any()  # all of it is in the picture
    assert not picture[:, 0].any()


def test_a_coating_dims_ghosts_as_its_reflectance_says(ghost_pass: GhostPass) -> None:
    bare, coated = singlet(22.0), singlet(22.0, coating_nm=510.0)
    view = view_of(bare, 200, 200, 60.0)
    source = [Source((0.0, 0.0), WHITE)]
    lines = Spectrum((650.0, 510.0, 475.0), np.eye(3))
    before = energy(ghost_pass.draw(ghost_sheets(bare, source, lines), view, ROUND), view)
    after = energy(ghost_pass.draw(ghost_sheets(coated, source, lines), view, ROUND), view)
    least = ((N - 1.38**2) / (N + 1.38**2)) ** 4 / ((N - 1) / (N + 1)) ** 4
    assert after[1] / before[1] == pytest.approx(least, rel=0.02)
    assert after[0] / before[0] > after[2] / before[2] > after[1] / before[1]
    # one line for each channel stands for what makes up the channel
    channels = energy(ghost_pass.draw(ghost_sheets(coated, source, THREE_LINES), view, ROUND), view)
    for k in range(3):
        band = reflectance(1.0, N, 1.0, band_nm(THREE_LINES, k), 510.0) * reflectance(
            N, 1.0, 1.0, band_nm(THREE_LINES, k), 510.0
        )
        assert channels[k] == pytest.approx(band.mean(), rel=0.02)


def test_the_picture_has_the_light_that_is_traced_ray_by_ray(ghost_pass: GhostPass) -> None:
    lens = double_gauss(5.6)
    iris = transmission(IrisShape(blades=5, rotation_rad=0.3), 512)
    share = float(iris.mean() * 4 / np.pi)
    slope = (0.21, -0.13)
    view, rough = view_of(lens, 288, 192), view_of(lens, 18, 12)
    drawn = ghost_pass.draw(ghost_sheets(lens, [Source(slope, WHITE)], spectrum(1), share), view, iris)[..., 1]
    drawn = drawn.reshape(12, 16, 18, 16).mean(axis=(1, 3))
    slow = _ray_by_ray(lens, slope, rough, iris, share)
    assert drawn.mean() == pytest.approx(slow.mean(), rel=0.02)
    assert np.abs(drawn - slow).mean() < 0.05 * slow.mean()


def _ray_by_ray(
    lens: FocusedLens, slope: tuple[float, float], view: PinholeView, iris: DoubleArray, share: float
) -> DoubleArray:
    """All ghosts by an even grid of rays over the front lens."""
    half = lens.prescription.surfaces[0].semi_diameter_mm + 2.0
    side = 110
    line = (np.arange(side) + 0.5) / side * 2 * half - half
    x, y = (a.ravel() for a in np.meshgrid(line, line))
    points = np.stack([x, y, np.full(x.shape, lens.vertices_mm[0])], axis=1)
    direction = np.array([-slope[0], -slope[1], 1.0])
    headings = np.tile(direction / np.linalg.norm(direction), (len(x), 1))
    total = np.zeros((view.height, view.width))
    for path in ghost_paths(lens.prescription):
        rays = trace_ghost(lens, path, points, headings)
        stops = np.sign(lens.first.entrance_pupil_magnification) * np.nan_to_num(rays.stops, nan=9.0)
        column = np.clip((stops[..., 0] + 1) / 2 * len(iris), 0, len(iris) - 1).astype(int)
        row = np.clip((1 - stops[..., 1]) / 2 * len(iris), 0, len(iris) - 1).astype(int)
        is_open = (iris[row, column] * (np.abs(stops) <= 1).all(axis=-1)).prod(axis=1)
        light = np.where(rays.arrives & (rays.rim <= 1), rays.light * is_open, 0.0)
        px = view.cx - view.fx * rays.film_mm[:, 0] / lens.image_scale_mm
        py = view.cy + view.fy * rays.film_mm[:, 1] / lens.image_scale_mm
        hits = (light > 0) & (px >= 0) & (px < view.width) & (py >= 0) & (py < view.height)
        np.add.at(total, (py[hits].astype(int), px[hits].astype(int)), light[hits])
    cell = (2 * half / side) ** 2 / (np.pi * lens.entrance_pupil_radius_mm**2 * share)
    return np.asarray(total * cell * view.fx * view.fy)


class Full:
    """A context with room for some objects, and then none."""

    def __init__(self, ctx: moderngl.Context, room: int) -> None:
        self._ctx, self._room = ctx, room

    def __getattr__(self, name: str) -> Any:
        made = getattr(self._ctx, name)
        return self._counted(made) if name in ("texture", "framebuffer", "buffer", "vertex_array") else made

    def __setattr__(self, name: str, value: object) -> None:
        if name.startswith("blend"):
            setattr(self._ctx, name, value)
        else:
            super().__setattr__(name, value)

    def _counted(self, make: Any) -> Any:
        def counted(*arguments: Any, **named: Any) -> Any:
            if self._room == 0:
                raise moderngl.Error("the device is full")
            self._room -= 1
            return make(*arguments, **named)

        return counted


def test_nothing_is_left_on_the_device_however_drawing_ends(renderer: FrameRenderer) -> None:
    def living() -> dict[str, list[int]]:
        kinds = ("Texture", "Buffer", "Framebuffer", "VertexArray")
        return {kind: [name for name in range(1, 200) if getattr(GL, f"glIs{kind}")(name)] for kind in kinds}

    lens, ctx = singlet(22.0), renderer.graphics.ctx
    sheets = list(ghost_sheets(lens, [Source((0.0, 0.0), WHITE)], THREE_LINES))
    before = living()
    for room in (*range(6), 100):
        ghost_pass = GhostPass(Full(ctx, room))  # type: ignore[arg-type]
        if room < 6:
            with pytest.raises(GraphicsError, match="the device is full"):
                ghost_pass.draw(sheets, view_of(lens, 200, 200, 60.0), ROUND)
        else:
            assert ghost_pass.draw(sheets, view_of(lens, 200, 200, 60.0), ROUND).any()
        ghost_pass.release()
        assert living() == before


def test_ghosts_turn_with_their_source(ghost_pass: GhostPass) -> None:
    lens = double_gauss(8.0)
    view = view_of(lens, 64, 64)
    right = ghost_pass.draw(ghost_sheets(lens, [Source((0.2, 0.0), WHITE)], THREE_LINES), view, ROUND)
    up = ghost_pass.draw(ghost_sheets(lens, [Source((0.0, 0.2), WHITE)], THREE_LINES), view, ROUND)
    assert np.abs(np.rot90(right) - up).mean() < 0.02 * up.mean()


def test_a_source_far_away_is_one_at_infinity_and_two_sources_add_up(ghost_pass: GhostPass) -> None:
    lens = singlet(5.6)
    view = view_of(lens, 64, 48)

    def drawn(*sources: Source) -> FloatArray:
        return ghost_pass.draw(ghost_sheets(lens, sources, THREE_LINES), view, ROUND)

    far, near = Source((0.2, 0.1), WHITE), Source((-0.1, 0.1), np.array([2.0, 1.0, 0.0]), 3.0)
    distant = replace(far, depth_m=1e5)
    alone = drawn(far)
    assert np.abs(drawn(distant) - alone).mean() < 0.01 * alone.mean()
    np.testing.assert_allclose(drawn(far, near), alone + drawn(near), rtol=1e-4, atol=1e-6)
    assert not drawn(near)[..., 2].any()
    assert not drawn(Source((9.0, 0.0), WHITE)).any()


def test_what_is_too_faint_is_left_out(ghost_pass: GhostPass) -> None:
    lens = double_gauss(8.0)
    whole = list(ghost_sheets(lens, [Source((0.2, 0.1), WHITE)], THREE_LINES))
    some = list(ghost_sheets(lens, [Source((0.2, 0.1), WHITE)], THREE_LINES, faintest=0.1))
    assert 0 < len(some) < len(whole)
    assert not list(ghost_sheets(lens, [Source((0.2, 0.1), WHITE)], THREE_LINES, faintest=1e9))
