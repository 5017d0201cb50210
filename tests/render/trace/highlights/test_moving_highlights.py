"""Highlights in motion from velocities: the light is that of closed forms, of many rays and of moments."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape, Lens, SeidelErrors
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Material, Scene
from render.optics.view import PinholeView
from tests.render.kits.bulbs import BULB, DARK, PANE, WALL, in_the_dark, plane

SETTINGS = FrameSettings(96, 72, rays=64, supersample=2, motion_by="velocities")
CAMERA = Camera(np.eye(4), 50.0, 32.0, 24.0, f_stop=1.4, focus_distance_m=0.8, near_m=0.1)
MOMENTS = 4
Path = Callable[[float], DoubleArray]


def path(
    x: float = 0.0, y: float = 0.0, z: float = 0.0, turn: float = 0.0, start: tuple[float, ...] = (0, 0, 0)
) -> Path:
    """Make poses from -0.5 to 0.5 that move by metres and turn to the side by radians."""

    def pose(time: float) -> DoubleArray:
        c, s = np.cos(turn * time), np.sin(turn * time)
        placed = np.eye(4)
        placed[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
        placed[:3, 3] = np.array(start) + np.array([x, y, z]) * time
        return placed

    return pose


STILL = path()


@dataclass(frozen=True)
class Motion:
    """A scene and a camera while the shutter is open."""

    scene: Callable[[float], Scene]
    camera: Callable[[float], Camera]

    def moment(self, i: int, count: int = MOMENTS, share: FloatArray | float | None = None) -> Moment:
        time = (i + 0.5) / count - 0.5
        return Moment(self.scene(time), self.camera(time), 1 / count if share is None else share)

    def render(
        self, renderer: FrameRenderer, settings: FrameSettings, shares: list[FloatArray] | None = None
    ) -> FloatArray:
        scenes = ShutterScenes(self.scene(0.0), self.scene(-0.5), self.scene(0.5))
        moments = [self.moment(i) for i in range(MOMENTS)]
        if shares is not None:
            moments = [self.moment(i, len(shares), share) for i, share in enumerate(shares)]
        per_pixel = None if shares is None else 1
        swept = renderer.render_swept(scenes, self.camera(0.0), moments, settings, moments_per_pixel=per_pixel)
        return swept.color[..., :3].astype(np.float64)


def camera_along(poses: Path, camera: Camera = CAMERA) -> Callable[[float], Camera]:
    return lambda time: replace(camera, world_from_camera=poses(time))


def leaning_bulb(poses: Path) -> tuple[DoubleArray, Callable[[float], Scene]]:
    """Make corners and scenes of a square that leans back to the right, in the dark."""
    square = rectangle((0.1, 0.05, -5.0), (0.03, 0, 0.015), (0, 0.03, 0))
    return square.positions.astype(np.float64), lambda time: in_the_dark(plane(square, BULB, poses(time)))


def image_area_px(corners: DoubleArray, pose: DoubleArray, camera: Camera) -> float:
    """Area of a polygon's sharp image, closed form."""
    view = PinholeView.from_camera(camera, SETTINGS.width, SETTINGS.height)
    there = view.camera_from_world @ pose
    x, y, z = (corners @ there[:3, :3].T + there[:3, 3]).T
    u, v = view.fx * x / -z, view.fy * y / -z
    return float(abs(np.sum(u * np.roll(v, -1) - v * np.roll(u, -1))) / 2)


LENSES = {
    "thin": CAMERA,
    "folded, blades": replace(
        CAMERA,
        iris=IrisShape(blades=6, rotation_rad=0.3),
        lens=Lens("seidel", seidel=SeidelErrors(w040=-60, reference_f_stop=1.4)),
    ),
}
BULBS = {
    "camera across": (STILL, path(0.3, 0.1), "thin"),
    "camera toward": (STILL, path(z=-0.6), "thin"),
    "camera turns": (STILL, path(turn=0.08), "thin"),
    "bulb across": (path(0.3, 0.1), STILL, "thin"),
    "bulb toward": (path(0, 0.1, 1.0), STILL, "thin"),
    "both": (path(-0.2, 0.1, 0.5), path(0.1, 0, -0.3, 0.03), "thin"),
    "both, scattered": (path(-0.2, 0.1, 0.5), path(0.1, 0, -0.3, 0.03), "folded, blades"),
}


@pytest.mark.parametrize(("bulb", "eye", "lens"), BULBS.values(), ids=BULBS)
def test_a_moving_bulb_has_the_light_of_its_image(renderer: FrameRenderer, bulb: Path, eye: Path, lens: str) -> None:
    """In the mean over the moments, its light is in proportion to the area of its sharp image."""
    corners, scene = leaning_bulb(bulb)
    motion = Motion(scene, camera_along(eye, LENSES[lens]))
    carried = motion.render(renderer, SETTINGS)
    still = Motion(lambda _: scene(0.0), camera_along(STILL, LENSES[lens])).render(renderer, SETTINGS)
    times = (np.arange(MOMENTS) + 0.5) / MOMENTS - 0.5
    areas = [image_area_px(corners, bulb(time), motion.camera(time)) for time in times]
    expected = np.mean(areas) / image_area_px(corners, bulb(0.0), CAMERA)
    np.testing.assert_allclose(carried.sum((0, 1)) / still.sum((0, 1)), expected, rtol=2e-3)


def bulbs(poses: Path, card: Path, material: Material = DARK) -> Callable[[float], Scene]:
    """Make scenes of bright squares of some two pixels of the layers before a dim wall, behind a card."""
    rng = np.random.default_rng(4)
    places = rng.uniform(-0.8, 0.8, (12, 2))
    lit = [rectangle((float(x), float(y), -5.0), (0.012, 0, 0), (0, 0.012, 0)) for x, y in places]
    wall, front = rectangle((0, 0, -6), (6, 0, 0), (0, 6, 0)), rectangle((0, 0, 0), (0.1, 0, 0), (0, 0.06, 0))
    return lambda time: in_the_dark(
        plane(wall, WALL), *(plane(square, BULB, poses(time)) for square in lit), plane(front, material, card(time))
    )


FRONT = (-0.05, -0.03, -1.0)
HERE = path(start=FRONT)
MOTIONS = {
    "camera": Motion(bulbs(STILL, HERE), camera_along(path(0.1, 0.05, -0.2, 0.02))),
    "bulbs": Motion(bulbs(path(0.3, 0.1, 0.3), HERE), camera_along(STILL)),
    "card": Motion(bulbs(STILL, path(0.1, start=FRONT)), camera_along(STILL)),
    "pane": Motion(bulbs(STILL, path(0.1, z=0.2, start=FRONT), PANE), camera_along(path(0.1))),
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_what_moves_keeps_the_light_of_many_rays_with_less_noise(renderer: FrameRenderer, motion: Motion) -> None:
    """Within 0.2 %, most of which is the noise of the rays; the mean squared error falls to less than a tenth."""
    by_rays = replace(SETTINGS, connections=False)
    truth = np.mean([motion.render(renderer, replace(by_rays, rays=512, seed=seed)) for seed in (1, 2)], axis=0)
    carried, noisy = motion.render(renderer, SETTINGS), motion.render(renderer, by_rays)
    np.testing.assert_allclose(carried.mean((0, 1)), truth.mean((0, 1)), rtol=2e-3)
    assert np.mean((carried - truth) ** 2) < np.mean((noisy - truth) ** 2) / 10


@pytest.mark.parametrize("material", [DARK, PANE], ids=["card", "pane"])
def test_a_moving_card_hides_what_it_hides_at_each_moment(renderer: FrameRenderer, material: Material) -> None:
    motion = Motion(bulbs(STILL, path(0.1, start=FRONT), material), camera_along(STILL))
    swept = motion.render(renderer, SETTINGS)
    peeled = [motion.moment(i) for i in range(MOMENTS)]
    exact = np.mean([renderer.render(one.scene, one.camera, SETTINGS).color[..., :3] for one in peeled], axis=0)
    np.testing.assert_allclose(swept.mean((0, 1)), exact.mean((0, 1)), rtol=1e-3)
    assert np.sqrt(np.mean((swept - exact) ** 2)) < 0.02 * exact.std()


def test_without_motion_it_is_the_still_picture(renderer: FrameRenderer) -> None:
    motion = Motion(bulbs(STILL, HERE), camera_along(STILL))
    swept = motion.render(renderer, SETTINGS)
    still = renderer.render(motion.scene(0.0), CAMERA, replace(SETTINGS, adaptive=False)).color[..., :3]
    np.testing.assert_allclose(swept.mean((0, 1)), still.mean((0, 1)), rtol=1e-3)
    assert np.sqrt(np.mean((swept - still) ** 2)) < 0.02 * still.std()


def test_lines_that_are_exposed_in_turn_have_the_light_of_all(renderer: FrameRenderer) -> None:
    motion = Motion(bulbs(STILL, HERE), camera_along(STILL))
    lines = np.arange(SETTINGS.height)[:, None, None]
    shares = [(lines // 18 == i).astype(np.float32) for i in range(4)]
    rolled, whole = motion.render(renderer, SETTINGS, shares), motion.render(renderer, SETTINGS)
    np.testing.assert_allclose(rolled.mean((0, 1)), whole.mean((0, 1)), rtol=1e-3)
    assert np.sqrt(np.mean((rolled - whole) ** 2)) < 0.03 * whole.std()
