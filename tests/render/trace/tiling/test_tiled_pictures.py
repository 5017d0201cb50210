"""Pictures traced in tiles: the same pixels as in one piece, within a stated memory."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import Cancelled
from render.lab.reference.metrics import psnr_db
from render.lab.reference.scenes import rectangle
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.focal_surface import Controls, FocalPlane, FocalSurface
from render.model.lens import IrisShape, Lens, SeidelErrors
from render.model.scene import Batch, Dome, Geometry, Material, Scene
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern
from render.trace.tiling.plan import LayerBudget, layers_bytes
from tests.render.kits.lens_pictures import SOFT_SHEET
from tests.render.kits.lenses import PLANAR

WIDE, TALL = (FrameSettings(*size, rays=12, supersample=2) for size in ((136, 80), (72, 104)))
ONE_PIECE = LayerBudget()
WHOLE_STRIP = LayerBudget(bytes=2_000_000, strip_bytes=1 << 40)
"""One strip, drawn with the borders of a picture in one piece, and windows much smaller than it."""
MANY_STRIPS, MORE_STRIPS = LayerBudget(2_000_000, 400_000), LayerBudget(2_900_000, 400_000)
"""The same strips in smaller and in larger windows."""
CAMERA = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.2, focus_distance_m=4.0, near_m=0.1)
BENT = Controls(np.array([[-0.2, 0.1], [0.25, -0.1]]), np.array([[0.6, 0.3], [0.15, 0.0]]), np.ones(2), np.zeros(2))
CAMERAS = {
    "thin": CAMERA,
    "closed": replace(CAMERA, f_stop=0.0),
    "tilted": replace(CAMERA, focal_surface=FocalSurface(FocalPlane(0.3, 0.2, 0.5))),
    "bent": replace(CAMERA, focal_surface=FocalSurface(FocalPlane(0.25), controls=BENT)),
    "shaped iris": replace(CAMERA, iris=IrisShape(blades=6)),
    "glass": replace(CAMERA, f_stop=2.0, lens=Lens("prescription", prescription=PLANAR.prescription)),
    "data sheet": replace(CAMERA, f_stop=2.8, lens=Lens("dataSheet", data_sheet=SOFT_SHEET)),
}

BRIGHT = replace(WIDE, rays=32, adaptive=False)
FEW_STRIPS, FEWER_STRIPS = LayerBudget(4_000_000, 900_000), LayerBudget(6_000_000, 900_000)
"""The same strips of some twenty pixels in smaller and in larger windows."""
NEAR = replace(CAMERA, focus_distance_m=0.8)
FOLDED = Lens("seidel", seidel=SeidelErrors(w040=-60, reference_f_stop=1.4))
BLURRED = {
    "thin": NEAR,
    "bent": replace(CAMERAS["bent"], focus_distance_m=0.8),
    "shaped iris": replace(NEAR, iris=IrisShape(blades=6)),
    "glass": replace(CAMERAS["glass"], focus_distance_m=0.8),
    "folded": replace(NEAR, lens=FOLDED),
}
"""Bulbs are out of focus. The last is scattered, that of glass in part."""


def confetti(count: int, opacity: float = 1.0) -> Scene:
    """Leaning triangles at 1 to 20 m in every direction of the view, before a sky; some larger than the view, some crossing the
    near plane."""
    rng = np.random.default_rng(11)
    depth = rng.uniform(1, 20, (count, 1, 1))
    middle = np.concatenate([rng.uniform(-0.5, 0.5, (count, 1, 2)) * depth, -depth], axis=2)
    corners = middle + rng.normal(0, 0.04, (count, 3, 3)) * depth * rng.choice([1, 1, 6], (count, 1, 1))
    corners = np.concatenate([corners, [[[-30, -1.5, 5], [30, -1.5, 5], [0, -1.5, -90]]]]).astype(np.float32)
    normals = np.repeat(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None], 3, axis=1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    half = len(corners) // 2
    batches = []
    for part, its_opacity in ((slice(0, half), opacity), (slice(half, None), 1.0)):
        own = corners[part]
        faces = np.arange(len(own), dtype=np.int32)
        shape = Geometry(
            own.reshape(-1, 3),
            normals[part].reshape(-1, 3).astype(np.float32),
            np.arange(3 * len(own), dtype=np.uint32).reshape(-1, 3),
            prim_ids=np.zeros(len(own), np.uint32),
            face_ids=faces,
            fan_ids=np.zeros(len(own), np.int32),
            colors=np.append(rng.uniform(0, 3, (3 * len(own), 3)), np.ones((3 * len(own), 1)), axis=1).astype(
                np.float32
            ),
        )
        material = Material(base_color=(1, 1, 1), opacity=its_opacity, uses_display_color=True)
        batches.append(Batch(shape, material, np.eye(4)[None], double_sided=True))
    return Scene(tuple(batches), (), Dome((0.4, 0.5, 0.9), np.eye(4)), ("/confetti",))


def bulbs_behind_confetti() -> Scene:
    """Bright squares of one or two texels of the layers at 5 to 15 m, behind and between some triangles, half transparent."""
    rng, scene = np.random.default_rng(5), confetti(40, opacity=0.5)
    bulb = Material(name="bulb", base_color=(0, 0, 0), emissive=(60.0, 50.0, 40.0))
    lit = []
    for _ in range(60):
        z = float(rng.uniform(5, 15))
        x, y = rng.uniform(-0.45, 0.45, 2) * z * [0.75, 0.5]
        square = rectangle((float(x), float(y), -z), (0.0025 * z, 0, 0), (0, 0.0025 * z, 0))
        lit.append(Batch(square, bulb, np.eye(4)[None], double_sided=True))
    return replace(scene, batches=(*scene.batches, *lit))


@pytest.fixture
def budget(renderer: FrameRenderer) -> Iterator[FrameRenderer]:
    """The renderer, whose budget a test may change."""
    yield renderer
    renderer.device.tracer.budget = ONE_PIECE


def drawn(
    renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings, budget: LayerBudget
) -> FloatArray:
    renderer.device.tracer.budget = budget
    return renderer.render(scene, camera, settings).color


@pytest.mark.parametrize("name", CAMERAS)
def test_tiles_have_the_pixels_of_one_piece(budget: FrameRenderer, name: str) -> None:
    """To the bit, for every kind of lens table and of focal surface, with transparent surfaces and more than four layers."""
    scene, settings = confetti(900, opacity=0.5), replace(WIDE, layers=6, shading="unlit")
    one = drawn(budget, scene, CAMERAS[name], settings, ONE_PIECE)
    assert np.ptp(one[..., :3]) > 1
    np.testing.assert_array_equal(drawn(budget, scene, CAMERAS[name], settings, WHOLE_STRIP), one)


@pytest.mark.parametrize("settings", [WIDE, TALL], ids=["wide", "tall"])
def test_pixels_do_not_depend_on_the_windows(budget: FrameRenderer, settings: FrameSettings) -> None:
    """The same strips give the same pixels through any window, to the bit, lit, in columns and in rows. With other strips the
    rasteriser rounds otherwise."""
    scene = confetti(900)
    small, large = (drawn(budget, scene, CAMERA, settings, memory) for memory in (MANY_STRIPS, MORE_STRIPS))
    np.testing.assert_array_equal(small, large)
    one = drawn(budget, scene, CAMERA, settings, ONE_PIECE)
    assert (small == one).all(axis=-1).mean() > 0.85
    assert psnr_db(small, one) > 45


def test_a_tiled_picture_can_be_shown_before_it_is_finished(budget: FrameRenderer) -> None:
    """Drawn in steps it is the same to the bit, its share grows to 1, and what is shown of it holds the finished pixels, and in
    the others the light of highlights."""
    scene, tracer = bulbs_behind_confetti(), budget.device.tracer
    one = drawn(budget, scene, NEAR, BRIGHT, WHOLE_STRIP)
    view = PinholeView.from_camera(NEAR, BRIGHT.width, BRIGHT.height)
    pattern = make_ray_pattern(BRIGHT.rays, NEAR.iris)
    with budget.graphics.cancellation.cancel_when(lambda: False):
        work = tracer.trace_steps(budget.device.peeler, NEAR, view, pattern, layers=4, supersample=2)
        shares = []
        while True:
            try:
                shares.append(next(work))
            except StopIteration as end:
                color = end.value.color
                break
            picture, finished = tracer.partial_picture()
            everywhere = (finished == 1)[..., 0]
            np.testing.assert_array_equal(picture[everywhere], one[everywhere])
            assert finished.mean() == pytest.approx(shares[-1], abs=1e-5)
    np.testing.assert_array_equal(color, one)
    assert shares == sorted(shares)
    assert shares[-1] == 1.0
    assert len(shares) > 3


def test_layers_of_tiles_keep_to_the_budget(budget: FrameRenderer) -> None:
    """The textures take as much memory as is counted beforehand."""
    settings = replace(WIDE, width=200, height=120, rays=1)
    scene, tracer, peeler = confetti(300), budget.device.tracer, budget.device.peeler
    drawn(budget, scene, CAMERA, settings, ONE_PIECE)
    view = PinholeView.from_camera(CAMERA, settings.width, settings.height)
    pattern = make_ray_pattern(2, CAMERA.iris)
    for memory in (ONE_PIECE, LayerBudget(4_200_000, 400_000)):
        tracer.budget = memory
        traced = tracer.picture(peeler, CAMERA, view, pattern, layers=4, supersample=2)
        held = traced.layers.targets.bytes + traced.nbuffers.bytes
        assert held == layers_bytes(*traced.layers.view.size, 4, lit=memory is ONE_PIECE)
        assert held <= memory.bytes
    assert held < 0.5 * layers_bytes(*traced.layers.whole.size, 4)


@pytest.mark.parametrize("camera", BLURRED.values(), ids=BLURRED)
def test_highlights_of_tiles_are_those_of_one_piece(budget: FrameRenderer, camera: Camera) -> None:
    """To the bit, where one strip is all of the layers; and through any window of the same strips."""
    scene = bulbs_behind_confetti()
    one = drawn(budget, scene, camera, BRIGHT, ONE_PIECE)
    by_rays = drawn(budget, scene, camera, replace(BRIGHT, connections=False), ONE_PIECE)
    assert (one != by_rays).any(axis=-1).mean() > 0.03  # something is carried
    np.testing.assert_array_equal(drawn(budget, scene, camera, BRIGHT, WHOLE_STRIP), one)
    small, large = (drawn(budget, scene, camera, BRIGHT, memory) for memory in (FEW_STRIPS, FEWER_STRIPS))
    np.testing.assert_array_equal(small, large)


@pytest.mark.parametrize("name", ["thin", "folded"])
def test_tiles_keep_their_light_with_less_noise(budget: FrameRenderer, name: str) -> None:
    """As without connections: the light of many rays within 0.15 %, three times the deviation of that without."""
    scene, camera, many = bulbs_behind_confetti(), BLURRED[name], replace(BRIGHT, rays=512)
    carried = drawn(budget, scene, camera, BRIGHT, FEW_STRIPS)
    by_rays = drawn(budget, scene, camera, replace(BRIGHT, connections=False), FEW_STRIPS)
    truth = drawn(budget, scene, camera, replace(many, connections=False), FEW_STRIPS)
    errors = [float(np.mean((picture - truth)[..., :3] ** 2)) for picture in (carried, by_rays)]
    assert errors[0] < errors[1] / 3
    light = drawn(budget, scene, camera, many, FEW_STRIPS)[..., :3].mean((0, 1))
    np.testing.assert_allclose(light, truth[..., :3].mean((0, 1)), rtol=1.5e-3)


def test_a_tiled_picture_that_was_cancelled_is_drawn_again(budget: FrameRenderer) -> None:
    """Wherever it was cancelled, nothing of it is left."""
    scene = bulbs_behind_confetti()
    whole = drawn(budget, scene, NEAR, BRIGHT, FEW_STRIPS)
    for passed in range(5, 10_000, 101):
        polls = iter(range(passed))
        with budget.graphics.cancellation.cancel_when(lambda polls=polls: next(polls, None) is None):
            try:
                budget.render(scene, NEAR, BRIGHT)
            except Cancelled:
                continue
            break
    assert passed > 200
    np.testing.assert_array_equal(drawn(budget, scene, NEAR, BRIGHT, FEW_STRIPS), whole)
