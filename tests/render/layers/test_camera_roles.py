"""Surfaces that the camera does not see, and holdouts, which hide what is behind them and leave neither colour nor alpha."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.engines import engine_names
from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.mattes import id_of
from render.model.moment import Moment, ShutterScenes
from render.model.scene import Batch, CameraRole, Dome, Light, Material, Scene
from tests.render.kits.lenses import PLANAR

pytestmark = pytest.mark.gl

SETTINGS = FrameSettings(96, 64, rays=32, supersample=2, shading="unlit", adaptive=False, connections=False)
CAMERA = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.4, focus_distance_m=4.0, near_m=0.1)
NAMES = ("/wall", "/post", "/ball", "/pane")
HERE = np.eye(4)[None]
SKY = Dome((0.25, 0.5, 1.0), np.eye(4))
GLASS = replace(CAMERA, f_stop=2.0, lens=replace(CAMERA.lens, model="prescription", prescription=PLANAR.prescription))


def scene(
    role: CameraRole, *, held: str = "/post", opacity: float = 1.0, pane: float = 0.5, shade: float = 0.0
) -> Scene:
    """A wall on the left, a post and a ball before it, and a pane in front of all; one has a role and looks of its own."""
    shapes = (
        rectangle((-2.5, 0, -8), (2.5, 0, 0), (0, 4, 0), prim=0),
        rectangle((0.25, 0, -2), (0.1, 0, 0), (0, 2, 0), prim=1),
        sphere((0.1, 0.1, -4), 0.4, prim=2),
        rectangle((0.2, -0.25, -1.5), (0.2, 0, 0), (0, 0.1, 0), prim=3),
    )
    colours = {"/wall": (0.5, 0.5, 0.5), "/post": (1.0, 0.0, 0.0), "/ball": (0.0, 2.0, 0.0), "/pane": (0.0, 0.0, 3.0)}
    batches = []
    for name, shape in zip(NAMES, shapes, strict=True):
        material = Material(base_color=colours[name], opacity=pane if name == "/pane" else 1.0)
        if name == held:
            material = replace(material, base_color=(shade,) * 3, opacity=opacity)
        batches.append(Batch(shape, material, HERE, camera_role=role if name == held else "seen"))
    return Scene(tuple(batches), (), SKY, NAMES)


def coverage(frame: Frame, name: str) -> FloatArray:
    ranked = frame.aovs["cryptoObject"]
    return np.where(ranked[..., 0::2] == id_of(name), ranked[..., 1::2], 0).sum(axis=-1)


@pytest.mark.parametrize("held", ["/post", "/ball", "/wall"])
@pytest.mark.parametrize("lens", ["thin", "glass", "pinhole", "adaptive", "many passes"])
@pytest.mark.parametrize("opacity", [1.0, 0.375])
def test_a_holdout_is_black_and_out_of_alpha(renderer: FrameRenderer, held: str, lens: str, opacity: float) -> None:
    """Its picture is that of a black surface, as blurred, and alpha lacks what the black surface covers."""
    settings = {
        "thin": SETTINGS,
        "glass": replace(SETTINGS, wavelengths=1),
        "pinhole": replace(SETTINGS, engine="pinhole"),
        "adaptive": replace(SETTINGS, adaptive=True),
        "many passes": replace(SETTINGS, rays=200),
    }[lens]
    settings = replace(settings, aovs=("color", "cryptoObject"))
    camera = GLASS if lens == "glass" else CAMERA
    black = renderer.render(scene("seen", held=held, opacity=opacity), camera, settings)
    frame = renderer.render(scene("holdout", held=held, opacity=opacity, shade=9.0), camera, settings)

    np.testing.assert_allclose(frame.color[..., :3], black.color[..., :3], atol=2e-5)
    part = coverage(black, held)
    np.testing.assert_allclose(frame.color[..., 3], black.color[..., 3] - part, atol=2e-5)
    assert ((part > 0.02) & (part < 0.98 * opacity)).sum() > (10 if lens == "pinhole" else 50)
    for name in NAMES:
        expected = 0 if name == held else coverage(black, name)
        np.testing.assert_allclose(coverage(frame, name), expected, atol=2e-5, err_msg=name)
    assert held not in frame.matte_names["cryptoObject"]


@pytest.mark.parametrize("opacity", [1.0, 0.375])
def test_holdouts_are_those_of_the_accumulation_buffer(renderer: FrameRenderer, opacity: float) -> None:
    settings = replace(SETTINGS, rays=64, supersample=3)
    frame = renderer.render(scene("holdout", opacity=opacity), CAMERA, settings)
    slow = renderer.render(scene("holdout", opacity=opacity), CAMERA, replace(settings, engine="accumulation"))
    assert np.sqrt(np.mean((frame.color - slow.color) ** 2, axis=(0, 1))).max() < 0.02
    assert frame.color[..., 3].min() < 0.01


def test_passes_that_hold_each_other_out_add_up(renderer: FrameRenderer) -> None:
    """The picture of each surface alone, all others held out, and of the dome before which all are: their sum is all of it."""
    settings = replace(SETTINGS, connections=True, rays=64)
    whole = scene("seen")
    parts = []
    for name in (*NAMES, "/sky"):
        batches = [
            replace(batch, camera_role="seen" if other == name else "holdout")
            for other, batch in zip(NAMES, whole.batches, strict=True)
        ]
        sky = replace(SKY, visible=name == "/sky")
        parts.append(renderer.render(replace(whole, batches=tuple(batches), dome=sky), CAMERA, settings).color)
    right = renderer.render(whole, CAMERA, settings).color
    np.testing.assert_allclose(np.sum(parts, axis=0), right, atol=1e-4)


def panes(*opacities: float) -> Scene:
    """Panes across the view, every other one a holdout, before a wall of radiance 2."""
    batches = [
        Batch(
            rectangle((0, 0, -1 - 0.01 * i), (9, 0, 0), (0, 9, 0)),
            Material(base_color=(1.0,) * 3, opacity=opacity),
            HERE,
            camera_role="holdout" if i % 2 else "seen",
        )
        for i, opacity in enumerate(opacities)
    ]
    wall = Batch(rectangle((0, 0, -3), (27, 0, 0), (0, 27, 0)), Material(base_color=(2.0,) * 3), HERE)
    return Scene((*batches, wall), (), SKY, ("/pane",))


@pytest.mark.parametrize("engine", ["lens", "pinhole", "accumulation"])
@pytest.mark.parametrize("count", [2, 6])
def test_holdouts_between_panes_dim_what_is_behind(renderer: FrameRenderer, engine: str, count: int) -> None:
    """Each pane adds its share of what those in front let through; holdouts add nothing, and let as little through."""
    opacities, passing, light, alpha = [0.25, 0.5] * (count // 2), 1.0, 0.0, 0.0
    for i, opacity in enumerate(opacities):
        light += (1 - i % 2) * passing * opacity
        alpha += (1 - i % 2) * passing * opacity
        passing *= 1 - opacity
    frame = renderer.render(panes(*opacities), CAMERA, replace(SETTINGS, engine=engine, rays=4, layers=8))
    expected = [light + 2 * passing] * 3 + [alpha + passing]
    np.testing.assert_allclose(frame.color[32, 48], expected, rtol=2e-3)


@pytest.mark.parametrize("layers", [1, 4])
def test_more_panes_than_layers_before_a_holdout(renderer: FrameRenderer, layers: int) -> None:
    """Panes that are merged over an opaque holdout keep their own alpha."""
    glass = [replace(batch, camera_role="seen") for batch in panes(*[0.25] * 12).batches]
    held = replace(glass.pop(), camera_role="holdout")
    frame = renderer.render(
        Scene((*glass, held), (), SKY, ("/pane",)), CAMERA, replace(SETTINGS, engine="pinhole", rays=1, layers=layers)
    )
    np.testing.assert_allclose(frame.color[32, 48], [1 - 0.75**12] * 4, rtol=1e-2)


def test_light_leaves_holdouts_black(renderer: FrameRenderer) -> None:
    """Lit from the camera and by the sky, behind a bare sky: nothing is left where the holdout covers all."""
    wall = Batch(rectangle((0, 0, -4), (0.8, 0, 0), (0, 0.8, 0)), Material(roughness=0.2, clearcoat=1.0), HERE)
    lamp = Light("distant", (9.0,) * 3, np.eye(4))
    for shading in ("lit", "unlit"):
        settings = replace(SETTINGS, shading=shading)
        seen, held = (
            renderer.render(Scene((replace(wall, camera_role=role),), (lamp,), SKY, ("/wall",)), CAMERA, settings).color
            for role in ("seen", "holdout")
        )
        covered = seen[..., 3] == 1
        assert covered.sum() > 100
        assert (held[covered] == 0).all()
        assert (held[..., 3] == 0).all()
        np.testing.assert_allclose(held[..., :3], (1 - seen[..., 3:]) * [0.25, 0.5, 1.0], atol=2e-3)


def test_a_moving_holdout_is_smeared(renderer: FrameRenderer) -> None:
    """Motion by velocities: its picture is that of a black surface that moves likewise."""

    def swept(role: CameraRole) -> Frame:
        scenes = []
        for by_m in (0.0, -0.2, 0.2):
            still = scene(role, shade=0.0)
            moved = (replace(one, poses=one.poses + by_m * np.eye(4, k=3)[None]) for one in still.batches[1:2])
            scenes.append(replace(still, batches=(still.batches[0], *moved, *still.batches[2:])))
        settings = replace(SETTINGS, rays=16, motion_by="velocities", aovs=("color", "cryptoObject"))
        return renderer.render_swept(ShutterScenes(*scenes), CAMERA, [Moment(scenes[0], CAMERA, 1 / 8)] * 8, settings)

    black, frame = swept("seen"), swept("holdout")
    part = coverage(black, "/post")
    assert ((part > 0.02) & (part < 0.98)).sum() > 500
    np.testing.assert_allclose(frame.color[..., :3], black.color[..., :3], atol=2e-5)
    np.testing.assert_allclose(frame.color[..., 3], black.color[..., 3] - part, atol=2e-5)


@pytest.mark.parametrize("engine", [name for name in engine_names() if name not in ("lens", "pinhole", "accumulation")])
def test_blurs_show_holdouts_as_black_surfaces(renderer: FrameRenderer, engine: str) -> None:
    """They give alpha 1 everywhere, which `pullfocus record` names."""
    settings = replace(SETTINGS, engine=engine, supersample=1)
    for opacity in (1.0, 0.375):
        black, held = (
            renderer.render(scene(role, opacity=opacity), CAMERA, settings).color for role in ("seen", "holdout")
        )
        np.testing.assert_allclose(held, black, atol=1e-5)
        assert (held[..., 3] == 1).all()


def test_aovs_have_nothing_where_a_holdout_is(renderer: FrameRenderer) -> None:
    empty = {
        "depth": np.inf,
        "cameraDepth": 0,
        "prim_id": 0,
        "primId": -1,
        "face_id": -1,
        "instanceId": -1,
        "normal": 0,
        "Neye": 0,
        "Peye": 0,
        "albedo": 0,
    }
    settings = replace(SETTINGS, engine="pinhole", supersample=1, rays=1, aovs=("color", *empty))
    seen = renderer.render(scene("seen", shade=1.0), CAMERA, settings).aovs
    held = renderer.render(scene("holdout", shade=1.0), CAMERA, settings).aovs
    there = seen["primId"] == NAMES.index("/post")
    assert there.sum() > 100
    for name, value in empty.items():
        assert (held[name][there] == value).all(), name
        if name != "albedo":  # behind the pane it has the holdout's share too
            np.testing.assert_array_equal(held[name][~there], seen[name][~there], err_msg=name)


def test_what_the_camera_does_not_see_leaves_its_shadow(renderer: FrameRenderer) -> None:
    """A ball before a wall, in the light of a lamp beside it: out of the camera's sight, it uncovers the wall and its shadow."""
    wall = Batch(rectangle((0, 0, -4), (4, 0, 0), (0, 4, 0)), Material(base_color=(0.5,) * 3, roughness=1.0), HERE)
    ball = Batch(sphere((0.0, 0.0, -2.0), 0.3, prim=1), Material(opacity=0.75), HERE)
    pose = np.eye(4)
    pose[:3, 3] = [1.0, 0.0, -0.5]
    lamp = Light("sphere", (500.0,) * 3, pose, radius_m=0.05)
    camera = replace(CAMERA, f_stop=0.0)
    settings = replace(SETTINGS, shading="lit", aovs=("color", "depth", "cryptoObject"))

    def render(*batches: Batch) -> Frame:
        return renderer.render(Scene(batches, (lamp,), None, ("/wall", "/ball")), camera, settings)

    bare, seen, unseen = render(wall), render(wall, ball), render(wall, replace(ball, camera_role="unseen"))
    free = coverage(seen, "/ball") == 0
    np.testing.assert_array_equal(unseen.color[free], seen.color[free])
    assert (unseen.color[..., 3] == 1).all()
    np.testing.assert_allclose(unseen.aovs["depth"], 4.0, rtol=1e-6)
    share = unseen.color[..., 0] / bare.color[..., 0]
    assert (share <= 1 + 1e-5).all()
    assert (share[free] < 0.05).sum() > 50, "its shadow beside it"
    assert (share[~free] > 1 - 1e-5).sum() > 500, "the wall behind it, in the light"
    assert "/ball" not in unseen.matte_names["cryptoObject"]


def test_what_is_unseen_takes_no_layers(renderer: FrameRenderer) -> None:
    """A pane right before the lens that the camera does not see changes no bit of the picture."""
    seen = scene("seen")
    close = Batch(rectangle((0, 0, -0.2), (1, 0, 0), (0, 1, 0)), Material(opacity=0.5), HERE, camera_role="unseen")
    with_pane = replace(seen, batches=(*seen.batches, close))
    for engine in ("lens", "accumulation", "flag"):
        settings = replace(SETTINGS, engine=engine, rays=8)
        frames = [renderer.render(one, CAMERA, settings).color for one in (seen, with_pane)]
        np.testing.assert_array_equal(*frames)
