"""Highlights carried to the pixels of their blurred images: the same light as by rays, and less noise."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from render.frame import FrameRenderer, FrameSettings
from render.gl.cancellation import CancellationPoint, Cancelled
from render.lab.reference.scenes import rectangle
from render.layers.peel import PICTURE
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.lens import Glass, HeightField, IrisShape, Lens, Prescription, SeidelErrors, Surface
from render.model.scene import Batch, Material, Scene
from render.pictures.progressive.frames import LiveFrames
from render.trace.highlights import carrier, finder, grouping, scattering
from tests.render.kits.bulbs import BULB, DARK, PANE, WALL, in_the_dark, plane
from tests.render.kits.data_sheets import SHEET
from tests.render.kits.lenses import PLANAR

SETTINGS = FrameSettings(128, 96, rays=64, supersample=2, adaptive=False)
CAMERA = Camera(np.eye(4), 50.0, 32.0, 24.0, f_stop=1.4, focus_distance_m=0.8, near_m=0.1)
IN_FRONT = (-0.05, -0.03, -1.0)


def bulbs(*others: Batch) -> Scene:
    """Make a dim wall with bright squares of some two pixels of the layers before it, and others."""
    rng = np.random.default_rng(4)
    lit = [
        rectangle((float(x), float(y), -5.0), (0.012, 0, 0), (0, 0.012, 0)) for x, y in rng.uniform(-0.9, 0.9, (12, 2))
    ]
    wall = rectangle((0.0, 0.0, -6.0), (6.0, 0, 0), (0, 6.0, 0))
    batches = [plane(wall, WALL), *(plane(square, BULB) for square in lit), *others]
    return in_the_dark(*batches)


def one_bulb() -> Scene:
    """Make a bright square on the axis, in the dark."""
    square = rectangle((0.0, 0.0, -5.0), (0.02, 0, 0), (0, 0.02, 0))
    return in_the_dark(plane(square, BULB))


def card(material: Material) -> Batch:
    """Make a card in front of the focus, before half of the bulbs."""
    return plane(rectangle(IN_FRONT, (0.1, 0, 0), (0, 0.06, 0)), material)


def pictures(renderer: FrameRenderer, scene: Scene, camera: Camera, **changes: object) -> tuple[FloatArray, FloatArray]:
    """Render with and without connections."""
    settings = replace(SETTINGS, **changes)  # type: ignore[arg-type]
    with_them = renderer.render(scene, camera, settings).color
    return with_them, renderer.render(scene, camera, replace(settings, connections=False)).color


SCENES = {"open": (), "behind a card": (card(DARK),), "behind a pane": (card(PANE),)}


@pytest.mark.parametrize("others", SCENES.values(), ids=SCENES)
def test_the_light_of_a_picture_stays_the_same(renderer: FrameRenderer, others: tuple[Batch, ...]) -> None:
    """Within 0.1 %, a fifth of which is the noise of the rays."""
    scene = bulbs(*others)
    carried, by_rays = pictures(renderer, scene, CAMERA, rays=256)
    assert carried[..., :3].std() < by_rays[..., :3].std()  # something was carried
    np.testing.assert_array_equal(carried[..., 3], by_rays[..., 3])
    seeds = [replace(SETTINGS, rays=256, connections=False, seed=seed) for seed in range(1, 6)]
    expected = np.mean([by_rays, *(renderer.render(scene, CAMERA, settings).color for settings in seeds)], axis=0)
    np.testing.assert_allclose(carried[..., :3].mean((0, 1)), expected[..., :3].mean((0, 1)), rtol=1e-3)


@pytest.mark.parametrize("others", SCENES.values(), ids=SCENES)
def test_pictures_converge_to_the_one_by_rays_alone(renderer: FrameRenderer, others: tuple[Batch, ...]) -> None:
    scene = bulbs(*others)
    truth = renderer.render(scene, CAMERA, replace(SETTINGS, rays=1024, connections=False)).color
    for rays in (16, 64):
        carried, by_rays = pictures(renderer, scene, CAMERA, rays=rays)
        errors = [float(np.mean((picture - truth)[..., :3] ** 2)) for picture in (carried, by_rays)]
        assert errors[0] < errors[1] / 10


MASK = np.ones((64, 64))
MASK[16:48, 20:50] = 0.1
NEAR = replace(CAMERA, focus_distance_m=0.5)
SPHERICAL = replace(CAMERA, lens=Lens("seidel", seidel=SeidelErrors(w040=-60, reference_f_stop=1.4)))
COLOURS = SeidelErrors(w040=3, w131=4, w222=2, w220=2, axial_color_mm=0.2, reference_f_stop=1.4)
CAMERAS = {
    "round": NEAR,
    "blades": replace(NEAR, iris=IrisShape(blades=6, rotation_rad=0.3)),
    "mask": replace(NEAR, iris=IrisShape(mask=MASK)),
    "weights": replace(NEAR, iris=IrisShape(radial_weights=(0.2, 0.5, 1.0))),
    "squeeze": replace(NEAR, lens=Lens(squeeze=2.0)),
    "colours": replace(NEAR, lens=Lens("seidel", seidel=COLOURS)),
    "colours, blades": replace(NEAR, iris=IrisShape(blades=7), lens=Lens("seidel", seidel=COLOURS)),
    "folded": SPHERICAL,
    "folded, blades": replace(SPHERICAL, iris=IrisShape(blades=6, rotation_rad=0.3)),
    "folded, mask": replace(SPHERICAL, iris=IrisShape(mask=MASK)),
    "power": replace(NEAR, lens=Lens(pupil_power=(1.0, 0.997, 1.003, 1.0), expressive_blend=1.0)),
}
"""Lenses without distortion and vignetting: they bring all light of a bulb to the picture."""


@pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)
def test_a_bulbs_blurred_image_has_the_light_of_its_texels(renderer: FrameRenderer, camera: Camera) -> None:
    carried, by_rays = pictures(renderer, one_bulb(), camera, rays=256)
    texels = np.frombuffer(radiance_bytes(renderer), np.float16).astype(np.float64).reshape(-1, 4)
    expected = texels[:, :3].sum(axis=0) / SETTINGS.supersample**2
    np.testing.assert_allclose(carried[..., :3].sum((0, 1)), expected, rtol=1e-3)
    assert not np.array_equal(carried, by_rays)


SINGLET = Prescription(
    (
        Surface(51.0, 6.0, Glass(1.5168, 64.17), 14.0),
        Surface(-51.0, 2.0, semi_diameter_mm=14.0),
        Surface(0.0, 0.0, is_stop=True),
    ),
    f_stop=2.8,
    name="singlet",
)
GLASS = Lens("prescription", "planar", PLANAR.prescription)
TABLES = {
    "glass": replace(NEAR, f_stop=4.0, lens=GLASS),
    "glass, blades": replace(NEAR, f_stop=2.8, iris=IrisShape(blades=7), lens=GLASS),
    "data sheet": replace(CAMERA, lens=Lens("dataSheet", data_sheet=SHEET)),
}
"""Lenses with distortion, and with rims that clip the pupil."""


@pytest.mark.parametrize("camera", TABLES.values(), ids=TABLES)
def test_highlights_through_glass_are_those_of_many_rays(renderer: FrameRenderer, camera: Camera) -> None:
    scene = bulbs(card(DARK))
    truth = renderer.render(scene, camera, replace(SETTINGS, rays=512, connections=False)).color
    carried, by_rays = pictures(renderer, scene, camera, rays=64)
    errors = [float(np.mean((picture - truth)[..., :3] ** 2)) for picture in (carried, by_rays)]
    assert errors[0] < errors[1] / 8
    np.testing.assert_allclose(carried[..., :3].mean((0, 1)), truth[..., :3].mean((0, 1)), rtol=1e-3)


FOLDED = {
    "spherical": SPHERICAL,
    "glass near focus": replace(CAMERA, focus_distance_m=1.5, lens=GLASS),
}
"""Lenses whose blurred images fold: spherical aberration is larger than the defocus, and of the other sign."""


@pytest.mark.parametrize("camera", FOLDED.values(), ids=FOLDED)
def test_folded_images_are_scattered_with_all_their_light(
    renderer: FrameRenderer, camera: Camera, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Within 0.3 % of many rays, and in bands of few rows to the bit as at once."""
    carried, by_rays = pictures(renderer, bulbs(), camera, rays=64)
    settings = [replace(SETTINGS, rays=512, connections=False, seed=seed) for seed in range(2)]
    truth = np.mean([renderer.render(bulbs(), camera, some).color for some in settings], axis=0)
    errors = [float(np.mean((picture - truth)[..., :3] ** 2)) for picture in (carried, by_rays)]
    assert errors[0] < errors[1] / 3
    np.testing.assert_allclose(carried[..., :3].mean((0, 1)), truth[..., :3].mean((0, 1)), rtol=3e-3)
    monkeypatch.setattr(scattering, "MOST_BYTES", 24 * SETTINGS.width * 37)
    np.testing.assert_array_equal(renderer.render(bulbs(), camera, SETTINGS).color, carried)


@pytest.mark.parametrize("iris", [IrisShape(), IrisShape(blades=6)], ids=["round", "blades"])
def test_highlights_through_a_height_field_keep_their_light(renderer: FrameRenderer, iris: IrisShape) -> None:
    y, x = np.mgrid[-1:1:64j, -1:1:64j]
    lens = Lens("heightField", prescription=SINGLET, height_field=HeightField(0.002 * np.sin(4 * x) * np.sin(3 * y)))
    camera = replace(CAMERA, f_stop=2.8, lens=lens, iris=iris)
    carried, by_rays = pictures(renderer, bulbs(), camera, wavelengths=1)
    many = replace(SETTINGS, wavelengths=1, rays=512, connections=False)
    truth = renderer.render(bulbs(), camera, many).color
    errors = [float(np.mean((picture - truth)[..., :3] ** 2)) for picture in (carried, by_rays)]
    assert errors[0] < errors[1] / 8
    np.testing.assert_allclose(carried[..., :3].mean((0, 1)), truth[..., :3].mean((0, 1)), rtol=3e-3)


def test_bars_before_what_is_in_focus_keep_their_light(renderer: FrameRenderer) -> None:
    """Light stays the same where bright edges, out of focus, lie before what is in focus."""
    wall = plane(rectangle((0.0, 0.0, -5.0), (6.0, 0, 0), (0, 6.0, 0)), WALL)
    bars = [
        plane(rectangle((float(x), 0.0, -1.515), (0.003, 0, 0), (0, 0.2, 0)), BULB) for x in np.linspace(-0.3, 0.3, 9)
    ]
    scene = in_the_dark(wall, *bars)
    carried, by_rays = pictures(renderer, scene, replace(CAMERA, focus_distance_m=5.0), rays=256)
    np.testing.assert_allclose(carried[..., :3].mean((0, 1)), by_rays[..., :3].mean((0, 1)), rtol=3e-3)


def test_the_blurred_image_of_a_bulb_is_even(renderer: FrameRenderer) -> None:
    """Within its circle of confusion, the standard deviation falls to a tenth at least."""
    square = rectangle((0.0, 0.0, -5.0), (0.01, 0, 0), (0, 0.01, 0))
    scene = in_the_dark(plane(square, BULB))
    carried, by_rays = pictures(renderer, scene, replace(CAMERA, focus_distance_m=0.5))
    inside = np.hypot(*(np.mgrid[:96, :128] + 0.5 - np.array([48.0, 64.0])[:, None, None])) < 5
    spread = [float(picture[inside, 0].std() / picture[inside, 0].mean()) for picture in (carried, by_rays)]
    assert spread[0] < 0.1 * spread[1]


@pytest.mark.parametrize("lens", [Lens(), Lens("seidel", seidel=COLOURS)], ids=["thin", "colours"])
def test_texels_of_a_large_blurred_image_are_carried_in_groups(
    renderer: FrameRenderer, lens: Lens, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nearly the picture of single texels, with the same light, behind a card too; within few connections it has less noise."""
    rng = np.random.default_rng(4)
    lit = [rectangle((float(x), float(y), -5.0), (0.03, 0, 0), (0, 0.03, 0)) for x, y in rng.uniform(-0.9, 0.9, (6, 2))]
    scene = bulbs(*(plane(square, BULB) for square in lit), card(DARK))
    camera, few = replace(CAMERA, focus_distance_m=0.3, lens=lens), replace(SETTINGS, rays=16)
    by_rays = renderer.render(scene, camera, replace(few, connections=False)).color
    monkeypatch.setattr(finder, "CONNECTIONS_PER_RAY", 0.4)
    scarce = renderer.render(scene, camera, few).color
    monkeypatch.setattr(finder, "CONNECTIONS_PER_RAY", 20.0)
    grouped = renderer.render(scene, camera, few).color
    monkeypatch.setattr(grouping, "MOST_SIDE", 1)
    single = renderer.render(scene, camera, few).color
    monkeypatch.setattr(finder, "CONNECTIONS_PER_RAY", 0.4)
    scarce_single = renderer.render(scene, camera, few).color

    def apart(picture: FloatArray) -> float:
        return float(np.sqrt(np.mean((picture - single)[..., :3] ** 2)))

    assert 0 < apart(grouped) < 0.03 * apart(by_rays)
    np.testing.assert_allclose(grouped[..., :3].mean((0, 1)), single[..., :3].mean((0, 1)), rtol=5e-4)
    assert apart(scarce) < 0.8 * apart(scarce_single)


def test_the_same_picture_twice(renderer: FrameRenderer) -> None:
    scene = bulbs(card(DARK))
    first = renderer.render(scene, CAMERA, SETTINGS).color
    renderer.forget_layers()
    np.testing.assert_array_equal(renderer.render(scene, CAMERA, SETTINGS).color, first)


def test_layers_are_put_back_bit_for_bit(renderer: FrameRenderer) -> None:
    scene = bulbs(card(PANE))
    renderer.render(scene, CAMERA, replace(SETTINGS, connections=False))
    before = radiance_bytes(renderer)
    carried = renderer.render(scene, CAMERA, SETTINGS).color
    assert radiance_bytes(renderer) == before
    np.testing.assert_array_equal(renderer.render(scene, CAMERA, SETTINGS).color, carried)


def test_layers_are_put_back_where_work_is_cancelled(renderer: FrameRenderer) -> None:
    """Wherever it is cancelled: there are as many places as a picture that is finished passes."""
    scene = bulbs()
    renderer.render(scene, CAMERA, SETTINGS)
    before = radiance_bytes(renderer)
    for passed in itertools.count():
        polls = iter(range(passed))
        with renderer.graphics.cancellation.cancel_when(lambda polls=polls: next(polls, None) is None):
            try:
                renderer.render(scene, CAMERA, SETTINGS)
            except Cancelled:
                assert radiance_bytes(renderer) == before
            else:
                break
    assert passed > 2


def test_layers_have_their_highlights_between_steps(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    """They are replaced once for a step, which has ten pieces by a clock that goes on by 2 ms with each reading."""
    monkeypatch.setattr("render.gl.cancellation.PIECE_MS", 0.5)
    monkeypatch.setattr(carrier, "STEP_MS", 20.0)
    seconds = itertools.count(step=0.002)
    monkeypatch.setattr(carrier, "perf_counter", seconds.__next__)
    written = []
    plain = carrier.CarriedHighlights._write
    monkeypatch.setattr(
        carrier.CarriedHighlights, "_write", lambda *args, **how: written.append(how) or plain(*args, **how)
    )
    pieces = []
    poll = CancellationPoint.poll
    monkeypatch.setattr(CancellationPoint, "poll", lambda point: pieces.append(point) or poll(point))
    scene = bulbs()
    renderer.render(scene, CAMERA, SETTINGS)
    before = radiance_bytes(renderer)
    written.clear()
    with renderer.graphics.cancellation.cancel_when(lambda: False):
        steps = 0
        for _ in LiveFrames(renderer).draw_in_steps(scene, CAMERA, SETTINGS):
            steps += 1
            assert radiance_bytes(renderer) == before
    assert len(written) - 2 * steps in (0, 2)  # once more where the last piece ends a step
    assert len(pieces) > 2 * len(written)


@pytest.mark.parametrize("changes", [{"rays": 1}, {"f_stop": 0.0}], ids=["one ray", "pinhole"])
def test_sharp_pictures_carry_nothing(renderer: FrameRenderer, changes: dict[str, float]) -> None:
    camera = replace(CAMERA, f_stop=changes.get("f_stop", CAMERA.f_stop))
    carried, by_rays = pictures(renderer, bulbs(), camera, rays=changes.get("rays", 16))
    np.testing.assert_array_equal(carried, by_rays)


def test_a_bright_wall_is_left_to_the_rays(renderer: FrameRenderer) -> None:
    wall = rectangle((0.0, 0.0, -6.0), (6.0, 0, 0), (0, 6.0, 0))
    carried, by_rays = pictures(renderer, in_the_dark(plane(wall, BULB)), CAMERA)
    np.testing.assert_array_equal(carried, by_rays)


def radiance_bytes(renderer: FrameRenderer) -> bytes:
    """Read the radiance of the layers that are kept."""
    _, layers = renderer.device.peeler._kept[PICTURE]
    slices: bytes = layers.targets.radiance.read()
    return slices[: len(slices) // layers.targets.radiance.layers * layers.count]


def test_means_are_measured_once_for_layers_that_are_kept(
    renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each focus finds highlights of its own among the same surroundings, as in layers that are new."""
    measured = []
    plain = finder.measure_means
    monkeypatch.setattr(finder, "measure_means", lambda *args: measured.append(args) or plain(*args))
    scene = bulbs()
    renderer.render(scene, CAMERA, SETTINGS)
    kept = renderer.render(scene, replace(CAMERA, focus_distance_m=0.81), SETTINGS).color
    assert len(measured) == 1
    renderer.forget_layers()
    np.testing.assert_array_equal(renderer.render(scene, replace(CAMERA, focus_distance_m=0.81), SETTINGS).color, kept)
    assert len(measured) == 2
