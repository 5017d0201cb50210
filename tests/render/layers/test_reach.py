"""Reach of lens rays behind peeled layers: the bound holds for every ray, and pictures do not change."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.shaders import ProgramCache
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import checkerboard, rectangle, sphere
from render.layers.peel import Peeler
from render.layers.peeled import Layers
from render.layers.reach import BLOCK_PX, CLOSED, OpenSides, ReachBounder
from render.layers.targets import LayerTargets
from render.layers.umbra import umbra_reach
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Lens
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.view import PinholeView
from render.trace.tiling.plan import LayerBudget
from tests.render.kits.lenses import PLANAR

HERE = np.eye(4)[None]
CAMERA = Camera(np.eye(4), 35, 24, 18, f_stop=0.7, focus_distance_m=3.0, near_m=0.1)
VIEW = PinholeView.from_camera(CAMERA, 160, 120)
PUPIL_PX = 12.0
FLAT = 128 | 128 << 8
"""Slope of a surface that faces the eye, packed as in ``trace/slopes.glsl``."""


@pytest.fixture
def bounder(renderer: FrameRenderer) -> Iterator[ReachBounder]:
    made = ReachBounder(renderer.graphics.ctx, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def bound_of(
    renderer: FrameRenderer, bounder: ReachBounder, *fields: FloatArray, open_sides: OpenSides = CLOSED
) -> FloatArray:
    """Bound the reach behind layers ``(height, width)`` of surfaces that face the eye, for each pixel."""
    height, width = fields[0].shape
    targets = LayerTargets.allocate(renderer.graphics.ctx, width, height, len(fields))
    try:
        targets.packed_w[0].write(
            np.stack([*fields, *[fields[0]] * (4 - len(fields))], -1).astype(np.float32).tobytes()
        )
        targets.packed_slopes[0].write(np.full((height, width, 4), FLAT, np.uint16).tobytes())
        for i, slot in enumerate(targets.slots):
            reach = bounder.bound(
                slot, targets.packed_slopes[0], umbra_reach(PUPIL_PX), is_first=i == 0, open_sides=open_sides
            )
        blocks = np.frombuffer(reach.read(), np.float32).reshape(reach.height, reach.width)
        return blocks.repeat(BLOCK_PX, 0).repeat(BLOCK_PX, 1)[:height, :width]
    finally:
        targets.release()


def reached(field: FloatArray, rays: int, seed: int) -> FloatArray:
    """Greatest w of random rays behind a layer, at each pixel; -1 where none came.

    Rays go from the front to w = 0 in small steps. A ray that comes behind the surface of the pixel that it is in is stopped;
    one that enters a pixel behind its surface has passed a gap.
    """
    height, width = field.shape
    rng = np.random.default_rng(seed)
    angle, pupil_px = rng.uniform(0, 2 * np.pi, rays), PUPIL_PX * np.sqrt(rng.uniform(0, 1, rays))
    b = pupil_px[:, None] * np.stack([np.cos(angle), np.sin(angle)], -1)
    meets = rng.uniform([0, 0], [width, height], (rays, 2))
    a = meets - b * rng.uniform(0, field.max(), rays)[:, None]
    most = np.full(field.shape, -1.0)
    alive, behind = np.ones(rays, bool), np.zeros(rays, bool)
    before = np.zeros(rays)  # w of the opaque surface of the last pixel; 0 without
    for w in np.linspace(field.max() * 1.01, 0, 800):
        x, y = np.clip(np.floor(a + b * w).astype(int), 0, [width - 1, height - 1]).T
        here = field[y, x]
        now_behind = np.abs(here) > w
        alive &= ~(now_behind & ~behind & ((before > w) | (before == here)) & (here > 0))
        behind, before = now_behind, np.maximum(here, 0)
        counted = alive & behind
        np.maximum.at(most, (y[counted], x[counted]), w)
    return most


def height_field(seed: int) -> FloatArray:
    """A wall with cards, bars and holes before it, at inverse depths from 0.3 to 3 per metre."""
    rng = np.random.default_rng(seed)
    field = np.full((60, 80), 0.3)
    for _ in range(9):
        (x, y), (width, height) = rng.integers(0, [70, 50]), rng.integers(1, [25, 25])
        field[y : y + height, x : x + width] = rng.choice([0.0, rng.uniform(0.3, 3)], p=[0.15, 0.85])
    return field


@pytest.mark.parametrize("seed", [0, 1])
def test_no_ray_is_nearer_than_the_bound(renderer: FrameRenderer, bounder: ReachBounder, seed: int) -> None:
    """Sampled rays behind a height field never exceed the bound, and come within ten pixels' fall of it almost everywhere."""
    field = height_field(seed)
    field[10:14, 5:9] *= -1  # lets rays through
    bound, most = bound_of(renderer, bounder, field), reached(field, 15_000, seed)
    assert (most > 0).mean() > 0.2
    assert (most <= bound + 1e-6).all()
    seen = most > 0
    assert np.median((np.minimum(bound, np.abs(field)) - most)[seen]) < 10 / PUPIL_PX


@pytest.mark.parametrize("seed", [0, 1])
def test_rays_come_into_a_strip_through_its_open_sides(
    renderer: FrameRenderer, bounder: ReachBounder, seed: int
) -> None:
    """Sampled rays of the whole never exceed the bound of a strip that is cut from it, and some exceed that of closed sides."""
    field = height_field(seed)
    most = reached(field, 40_000, seed)
    for strip, sides in (((slice(None), slice(30, 52)), (1, 0, 1, 0)), ((slice(20, 60), slice(None)), (0, 1, 0, 0))):
        opened = bound_of(renderer, bounder, field[strip], open_sides=tuple(map(bool, sides)))
        assert (most[strip] <= opened + 1e-6).all()
        assert (opened >= bound_of(renderer, bounder, field[strip])).all()


def test_a_closed_wall_lets_nothing_past_and_a_gap_some(renderer: FrameRenderer, bounder: ReachBounder) -> None:
    wall = np.full((40, 60), 2.0)
    assert (bound_of(renderer, bounder, wall) < 0).all()
    wall[:, 30:] = 0.5
    bound = bound_of(renderer, bounder, wall)
    assert (bound[:, 20:40] > 1.1).all()
    along = bound[0, :25:2]
    np.testing.assert_allclose(np.diff(along), 2 / PUPIL_PX / np.sqrt(2), rtol=1e-4)
    assert bound[0, 0] < 2 - (30 - 6) / PUPIL_PX / np.sqrt(2)


def test_a_second_layer_bounds_what_passed_the_first(renderer: FrameRenderer, bounder: ReachBounder) -> None:
    """A card before a wall that has a hole behind the card, too far from its edges to be seen through."""
    card, wall = np.full((60, 100), 0.5), np.zeros((60, 100))
    card[:, 20:80] = 2.0
    wall[:, 20:80] = 0.5
    one, closed = bound_of(renderer, bounder, card), bound_of(renderer, bounder, card, wall)
    assert (closed <= one).all()
    wall[:, 49:51] = 0.1
    holed = bound_of(renderer, bounder, card, wall)
    assert (holed >= closed).all()
    assert holed[30, 50] <= one[30, 50]


def clutter(seed: int, *, panes: bool) -> Scene:
    """Thin bars, leaning cards and spheres over a floor before three walls, some of them partly transparent with ``panes``."""
    rng = np.random.default_rng(seed)
    batches = []

    def add(*geometry: Any) -> None:
        opacity = rng.uniform(0.2, 0.7) if panes and rng.uniform() < 0.3 else 1.0
        red, green, blue = rng.uniform(0.05, 0.95, 3)
        material = Material(base_color=(red, green, blue), opacity=opacity)
        batches.extend(Batch(one, material, HERE, double_sided=True) for one in geometry)

    for _ in range(25):
        z = rng.uniform(1.5, 8)
        x, y = rng.uniform(-0.4, 0.4, 2) * z
        half, lean, tall = rng.uniform([0.004, -0.1, 0.1], [0.02, 0.1, 0.4]) * z
        add(rectangle((x, y, -z), (half, 0, 0), (lean, tall, 0)))
    for _ in range(12):
        z = rng.uniform(2, 9)
        x, y = rng.uniform(-0.4, 0.4, 2) * z
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.05, 0.2) * z
        add(rectangle((x, y, -z), tuple(turn[0]), tuple(turn[1])))
    for _ in range(6):
        z = rng.uniform(2, 9)
        x, y = rng.uniform(-0.4, 0.4, 2) * z
        add(sphere((x, y, -z), rng.uniform(0.1, 0.5), 24))
    for z in (10.0, 11.0, 14.0):
        batches.append(
            Batch(rectangle((0, 0, -z), (20, 0, 0), (0, 20, 0)), Material(base_color=(z / 14, 0.4, 0.1)), HERE)
        )
    floor = Material(uses_display_color=True, base_color=(1, 1, 1))
    batches.append(Batch(checkerboard(20, 36, 0.6, -1.0, -2.0), floor, HERE, double_sided=True))
    return Scene(tuple(batches), (), Dome((0.9, 0.9, 0.9), np.eye(4)), ("/clutter",))


def pictures(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch, scene: Scene, camera: Camera
) -> tuple[FloatArray, FloatArray]:
    """Draw a picture with all surfaces, and one with only what rays reach."""
    settings = FrameSettings(120, 90, rays=64, layers=8, supersample=2, shading="unlit")
    peel, drawn = Peeler.peel, []
    for is_bounded in (False, True):

        def chosen(self: Peeler, view: PinholeView, is_bounded: bool = is_bounded, **options: Any) -> Layers:
            return peel(self, view, **(options if is_bounded else options | {"reachable": None}))

        monkeypatch.setattr(Peeler, "peel", chosen)
        drawn.append(renderer.render(scene, camera, settings).color)
    monkeypatch.undo()
    return drawn[0], drawn[1]


def assert_alike(reachable: FloatArray, everything: FloatArray) -> None:
    """Walks begin elsewhere where N-buffers hold less, and take other steps: some rays along edges meet what is beside."""
    assert psnr_db(reachable, everything) > 60
    assert np.abs(reachable - everything).max() < 0.03
    np.testing.assert_allclose(reachable.mean(axis=(0, 1)), everything.mean(axis=(0, 1)), rtol=2e-4)


@pytest.mark.parametrize("f_stop", [0.7, 2.0])
def test_pictures_of_opaque_scenes_stay_the_same(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch, f_stop: float
) -> None:
    everything, reachable = pictures(renderer, monkeypatch, clutter(1, panes=False), replace(CAMERA, f_stop=f_stop))
    assert_alike(reachable, everything)


def test_pictures_through_a_prescription_stay_the_same(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    lens = Lens("prescription", PLANAR.prescription.name, PLANAR.prescription)
    camera = replace(CAMERA, f_stop=PLANAR.f_stop, focal_length_mm=PLANAR.focal_length_mm, lens=lens)
    everything, reachable = pictures(renderer, monkeypatch, clutter(2, panes=False), camera)
    assert_alike(reachable, everything)


def test_pictures_in_tiles_stay_the_same(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(renderer.device.tracer, "budget", LayerBudget(2_000_000, 400_000))
    everything, reachable = pictures(renderer, monkeypatch, clutter(1, panes=False), CAMERA)
    assert_alike(reachable, everything)


def test_pictures_of_panes_stay_the_same(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    """A surface may take the place of a hidden one in its layer, so that a ray reads it from the pixel beside: in few pixels."""
    everything, reachable = pictures(renderer, monkeypatch, clutter(3, panes=True), CAMERA)
    changed = (reachable != everything).any(-1)
    assert changed.mean() < 0.02
    np.testing.assert_allclose(reachable, everything, atol=0.02)


def test_only_texels_near_edges_are_drawn_behind(renderer: FrameRenderer) -> None:
    """A near card hides all of a far one but a rim; behind a wall that nothing looks past, the peeling ends."""
    peeler = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    card, far, behind = (
        rectangle((0, 0, -z), (side, 0, 0), (0, side, 0)) for z, side in ((1, 0.15), (3.0, 9.0), (5.0, 9.0))
    )
    try:
        peeler.load(Scene(tuple(Batch(one, Material(), HERE) for one in (far, behind)), prim_paths=("/a",)))
        umbra = umbra_reach(VIEW.fx * 0.04)
        assert peeler.peel(VIEW, layers=4, umbra=umbra, unlit=True).count == 2
        assert peeler.peel(VIEW, layers=4, umbra=umbra, unlit=True, reachable=CLOSED).count == 1
        peeler.load(Scene(tuple(Batch(one, Material(), HERE) for one in (card, far)), prim_paths=("/a",)))
        layers = peeler.peel(VIEW, layers=4, umbra=umbra, unlit=True, reachable=CLOSED)
        w = np.frombuffer(layers.targets.packed_w[0].read(), np.float32).reshape(VIEW.height, VIEW.width, 4)
        hidden, seen = w[..., 0] > 0.9, w[..., 1] != 0
        assert layers.count == 2
        assert 0.3 < (hidden & seen).sum() / hidden.sum() < 0.8
        assert not seen[VIEW.height // 2, VIEW.width // 2], "no ray reaches the middle"
    finally:
        peeler.release()
