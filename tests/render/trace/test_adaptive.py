"""Adaptive rays: their mean is as asked, they lower the error, and a wanted error is reached."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.engines import DrawRequest
from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import encode_for_display, psnr_db
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray, IntArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.view import PinholeView
from render.trace import adaptive, tracer
from render.trace.adaptive import RayBudget, allocate, tile_errors, tile_pixels
from render.trace.rays import make_ray_pattern

SETTINGS = FrameSettings(96, 72, rays=64, supersample=1, shading="unlit", connections=False)
EXPOSED = replace(SETTINGS, adaptive=False)


def small_light_before_a_wall() -> tuple[Scene, Camera]:
    """Make a light of two pixels, far out of focus, before a wall that is sharp and plain."""
    camera = Camera(np.eye(4), 50.0, 32.0, 24.0, f_stop=0.35, focus_distance_m=4.0, near_m=0.1)
    glow = Material(name="glow", base_color=(0, 0, 0), emissive=(60.0, 50.0, 40.0))
    wall = Material(name="wall", base_color=(0.2, 0.2, 0.2))
    light = rectangle((-0.1, 0.03, -0.8), (0.004, 0, 0), (0, 0.004, 0))
    back = rectangle((0.0, 0.0, -4.0), (9, 0, 0), (0, 9, 0))
    batches = tuple(
        Batch(mesh, material, np.eye(4)[None], double_sided=True) for mesh, material in ((light, glow), (back, wall))
    )
    return Scene(batches, (), Dome((0, 0, 0), np.eye(4)), ("/light", "/wall")), camera


@pytest.fixture
def reference(renderer: FrameRenderer) -> FloatArray:
    return renderer.render(*small_light_before_a_wall(), replace(EXPOSED, rays=1024, seed=3)).color


@pytest.fixture
def allotted(monkeypatch: pytest.MonkeyPatch) -> list[IntArray]:
    """Give the rays of each tile after each round."""
    rounds: list[IntArray] = []

    def noting(*arguments: object) -> IntArray:
        rounds.append(allocate(*arguments))  # type: ignore[arg-type]
        return rounds[-1]

    monkeypatch.setattr(tracer, "allocate", noting)
    return rounds


def test_rays_are_spent_where_they_lower_the_error() -> None:
    pixels = tile_pixels(36, 20)  # narrower tiles at the right and lower edge
    assert pixels.tolist() == [[64, 64, 64, 64, 32], [64, 64, 64, 64, 32], [32, 32, 32, 32, 16]]
    errors = np.full(pixels.shape, 1e-6)
    errors[1, 2] = 1e-2
    budget = RayBudget(100)
    traced = np.full(pixels.shape, budget.first, np.int32)
    rays = allocate(errors, traced, pixels, budget)
    assert 0.98 * 100 * pixels.sum() < (rays * pixels).sum() <= 100 * pixels.sum()
    assert rays.min() == budget.first
    assert rays[1, 2] == rays.max() > 600

    def error(counts: IntArray) -> float:
        return float((pixels * errors * (budget.first / counts) ** adaptive.FALL).sum())

    assert error(rays) < 0.2 * error(np.full_like(rays, 100))
    assert (allocate(0 * errors, traced, pixels, budget) == 100).all()


def test_a_wanted_error_is_approached_in_rounds() -> None:
    budget = RayBudget(100, noise=0.01)
    traced = np.full((1, 4), 32, np.int32)
    errors = np.array([[0.5e-4, 1.5e-4, 1e-1, 0.0]])
    rays = allocate(errors, traced, tile_pixels(32, 8), budget)
    assert rays[0, 0] == rays[0, 3] == 32
    assert 32 * 1.5**0.8 <= rays[0, 1] < 32 * 1.5**0.8 + 2
    assert rays[0, 2] == 4 * 32
    assert (rays % 2 == 0).all()


def test_errors_are_those_of_the_encoded_picture() -> None:
    random = np.random.default_rng(1)
    halves = random.normal(0.5, 0.1, (2, 16, 24, 4)).astype(np.float32)
    halves[:, :8, 16:] += 3  # clipped: no error that a viewer would see
    errors = tile_errors(halves.sum(axis=0) * 8, (halves[0] - halves[1]) * 8, np.full((2, 3), 16), 1.0)
    low, high = encode_for_display(np.array([[0.49] * 3, [0.51] * 3], np.float32))[:, 0]
    slope = (high - low) / 0.02
    assert errors[1, 0] == pytest.approx((slope * 0.1) ** 2 / 2, rel=0.2)
    assert errors[0, 2] < 0.6 * errors[1, 0]
    assert errors[0, 2] > 0, "tiles around have a share"


def test_adaptive_rays_beat_as_many_uniform_ones(
    renderer: FrameRenderer, reference: FloatArray, allotted: list[IntArray]
) -> None:
    made = small_light_before_a_wall()
    adapted = renderer.render(*made, SETTINGS).color
    (rays,) = allotted
    assert 0.95 * 64 < (rays * tile_pixels(96, 72)).sum() / (96 * 72) <= 64
    assert rays.max() > 4 * rays.min()
    uniform = renderer.render(*made, EXPOSED).color
    assert psnr_db(adapted, reference) > psnr_db(uniform, reference) + 3
    assert adapted.mean() == pytest.approx(reference.mean(), rel=5e-3)


def test_a_wanted_error_is_reached(renderer: FrameRenderer, reference: FloatArray, allotted: list[IntArray]) -> None:
    picture = renderer.render(*small_light_before_a_wall(), replace(SETTINGS, noise=0.002)).color
    apart = encode_for_display(picture) - encode_for_display(reference)
    tiles = (apart**2).mean(axis=-1).reshape(9, 8, 12, 8).mean(axis=(1, 3))
    assert np.sqrt(tiles.max()) < 1.5 * 0.002  # of an estimate from 64 pixels
    assert np.sqrt(tiles.mean()) < 0.002
    assert allotted[-1].max() > 4 * allotted[-1].min()


def test_pieces_do_not_change_the_picture(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, camera = small_light_before_a_wall()
    whole = renderer.render(scene, camera, SETTINGS).color
    monkeypatch.setattr(tracer, "_RAYS_PER_DISPATCH", 1 << 13)
    engine = renderer.engine(SETTINGS)
    request = DrawRequest(PinholeView.from_camera(camera, 96, 72), renderer.load(scene, camera, SETTINGS), SETTINGS)
    shares = []
    finished: list[FloatArray] = []

    def steps() -> Iterator[float]:
        finished.append((yield from engine.draw_in_steps(request)))

    for share in steps():
        shares.append(share)
        if len(shares) == 20:
            partial, done = engine.partial_picture()
            assert 0 < done.mean() < 1
            assert np.isfinite(partial).all()
    assert np.array_equal(finished[0], whole)
    assert len(shares) > 40
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1)


def test_without_it_all_pixels_have_all_rays(renderer: FrameRenderer) -> None:
    scene, camera = small_light_before_a_wall()
    plain = renderer.render(scene, camera, EXPOSED).color
    device, view = renderer.device, PinholeView.from_camera(camera, 96, 72)
    with renderer.on_device():
        traced = device.tracer.picture(
            device.peeler,
            camera,
            view,
            make_ray_pattern(64, camera.iris),
            layers=4,
            supersample=1,
            unlit=True,
            connections=False,
        )
    assert np.array_equal(plain, traced.color)
