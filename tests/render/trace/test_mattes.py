"""Mattes through the lens: coverage by each prim against pictures in which each prim has a colour of its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.frame import Frame, FrameRenderer, FrameSettings
from render.lab.reference.scenes import rectangle, sphere
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.model.mattes import id_of
from render.model.scene import Batch, Dome, Material, Scene
from render.pictures.progressive.frames import LiveFrames
from render.trace.matte_tables import SLOTS
from tests.render.kits.lenses import PLANAR
from tests.render.kits.tiles import render_in_tiles

pytestmark = pytest.mark.gl

WIDTH, HEIGHT = 96, 64
SETTINGS = FrameSettings(
    WIDTH, HEIGHT, rays=32, supersample=2, shading="unlit", adaptive=False, connections=False, aovs=("cryptoObject",)
)
CAMERA = Camera(np.eye(4), 50.0, 36.0, 24.0, f_stop=1.4, focus_distance_m=4.0, near_m=0.1)
NAMES = ("/wall", "/post", "/ball", "/pane")
COLOURS = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
HERE = np.eye(4)[None]


def scene(*, pane: float = 1.0) -> Scene:
    """A black wall, a red post and a green ball before it, and a blue pane in front of all."""
    shapes = (
        rectangle((-2.5, 0, -8), (2.5, 0, 0), (0, 4, 0), prim=0),
        rectangle((0.25, 0, -2), (0.1, 0, 0), (0, 2, 0), prim=1),
        sphere((-0.4, 0.1, -4), 0.4, prim=2),
        rectangle((-0.6, -0.25, -1.5), (0.2, 0, 0), (0, 0.1, 0), prim=3),
    )
    batches = [
        Batch(shape, Material(base_color=colour, opacity=pane if shape is shapes[3] else 1.0), HERE)
        for shape, colour in zip(shapes, COLOURS, strict=True)
    ]
    return Scene(tuple(batches), (), Dome((0, 0, 0), np.eye(4), visible=False), NAMES)


def matte(frame: Frame, name: str, aov: str = "cryptoObject") -> FloatArray:
    ranked = frame.aovs[aov]
    return np.where(ranked[..., 0::2] == id_of(name), ranked[..., 1::2], 0).sum(axis=-1)


def total(frame: Frame, aov: str = "cryptoObject") -> FloatArray:
    return frame.aovs[aov][..., 1::2].sum(axis=-1)


LENSES = {
    "thin": (CAMERA, SETTINGS),
    "adaptive": (CAMERA, replace(SETTINGS, adaptive=True)),
    "many passes": (CAMERA, replace(SETTINGS, rays=200)),
    "pinhole": (CAMERA, replace(SETTINGS, engine="pinhole", rays=8)),
    "glass": (
        replace(CAMERA, f_stop=2.0, lens=replace(CAMERA.lens, model="prescription", prescription=PLANAR.prescription)),
        replace(SETTINGS, wavelengths=1),
    ),
}


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("pane", [1.0, 0.25])
def test_coverage_is_that_of_the_picture(renderer: FrameRenderer, lens: str, pane: float) -> None:
    camera, settings = LENSES[lens]
    frame = renderer.render(scene(pane=pane), camera, settings)

    np.testing.assert_allclose(total(frame), frame.color[..., 3], atol=2e-6)
    for i, name in enumerate(NAMES[1:]):
        np.testing.assert_allclose(matte(frame, name), frame.color[..., i], atol=1e-5, err_msg=name)
    blurred = (matte(frame, "/post") > 0.02) & (matte(frame, "/post") < 0.98)
    assert blurred.sum() > (20 if lens == "pinhole" else 150)


def test_mattes_are_blurred_as_by_accumulation(renderer: FrameRenderer) -> None:
    settings = replace(SETTINGS, rays=64, supersample=3)
    frame = renderer.render(scene(pane=0.5), CAMERA, settings)
    slow = renderer.render(scene(pane=0.5), CAMERA, replace(settings, engine="accumulation", aovs=("color",))).color

    for i, name in enumerate(NAMES[1:]):
        assert np.sqrt(np.mean((matte(frame, name) - slow[..., i]) ** 2)) < 0.02, name


def test_a_sharp_picture_has_the_mattes_of_its_ids(renderer: FrameRenderer) -> None:
    settings = replace(SETTINGS, engine="pinhole", rays=16, aovs=("color", "prim_id", "cryptoObject"))
    frame = renderer.render(scene(), CAMERA, settings)

    first = frame.aovs["cryptoObject"][..., 0]
    for number, name in enumerate(NAMES, start=1):
        whole = matte(frame, name) > 0.999
        assert whole.sum() > 30
        assert (frame.aovs["prim_id"][whole] == number).all()
        assert (first[whole] == id_of(name)).all()
    nothing = total(frame) == 0
    assert nothing.any()
    assert (frame.aovs["prim_id"][nothing] == 0).all()


def test_a_blurred_edge_has_the_coverage_of_its_closed_form(renderer: FrameRenderer) -> None:
    """Across a straight edge in front of the focus, coverage is the part of the disc of confusion on its side."""
    wall = Scene((Batch(rectangle((-4, 0, -1), (4, 0, 0), (0, 4, 0)), Material(), HERE),), (), None, ("/wall",))
    camera = replace(CAMERA, f_stop=0.4)
    frame = renderer.render(wall, camera, replace(SETTINGS, rays=1024, aovs=("color", "coc", "cryptoObject")))

    radius_px = abs(float(frame.aovs["coc"][HEIGHT // 2, 0]))
    assert radius_px > 5
    into = np.clip((WIDTH / 2 - np.arange(WIDTH) - 0.5) / radius_px, -1, 1)
    expected = (np.arccos(-into) + into * np.sqrt(1 - into**2)) / np.pi
    np.testing.assert_allclose(matte(frame, "/wall")[8:-8].mean(axis=0), expected, atol=0.01)


def test_tiles_give_the_mattes_of_one_piece(renderer: FrameRenderer) -> None:
    tiled, whole = render_in_tiles(renderer, scene(pane=0.5), CAMERA, SETTINGS)

    np.testing.assert_allclose(total(tiled), tiled.color[..., 3], atol=2e-6)
    for name in NAMES:
        np.testing.assert_allclose(matte(tiled, name), matte(whole, name), atol=1e-5)


def test_a_picture_in_steps_has_the_same_mattes(renderer: FrameRenderer) -> None:
    whole = renderer.render(scene(), CAMERA, SETTINGS)
    steps = LiveFrames(renderer).draw_in_steps(scene(), CAMERA, SETTINGS)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            frame = end.value
            break

    np.testing.assert_array_equal(frame.aovs["cryptoObject"], whole.aovs["cryptoObject"])
    assert frame.matte_names == whole.matte_names == {"cryptoObject": tuple(sorted(NAMES))}


def test_more_surfaces_than_slots_keep_the_sum_and_the_largest(renderer: FrameRenderer) -> None:
    count = 3 * SLOTS
    grain = [
        rectangle((0.02 * (i % 8 - 3.5), 0.02 * (i // 8 - 2.5), -1), (0.009, 0, 0), (0, 0.009, 0), prim=i + 1)
        for i in range(count)
    ]
    behind = rectangle((0, 0, -30), (40, 0, 0), (0, 40, 0))
    names = ("/behind", *(f"/grain{i}" for i in range(count)))
    batches = tuple(Batch(shape, Material(), HERE) for shape in (behind, *grain))
    camera = replace(CAMERA, f_stop=0.4, focus_distance_m=30.0)
    frame = renderer.render(Scene(batches, (), None, names), camera, replace(SETTINGS, rays=256))

    middle = np.s_[HEIGHT // 2 - 4 : HEIGHT // 2 + 4, WIDTH // 2 - 4 : WIDTH // 2 + 4]
    assert (frame.aovs["cryptoObject"][middle][..., 11] > 0).all(), "all ranks are taken"
    assert (total(frame) <= frame.color[..., 3] + 1e-5).all()
    white = [replace(b, material=Material(base_color=(float(i == 0),) * 3)) for i, b in enumerate(batches)]
    exact = renderer.render(Scene(tuple(white), (), None, names), camera, replace(SETTINGS, rays=256)).color[..., 0]
    assert exact[middle].max() > 1 / SLOTS
    assert (matte(frame, "/behind") >= exact - 1e-5).all(), "the largest is never lost"
    assert (matte(frame, "/behind") <= exact + 1 / SLOTS).all()


def test_instances_and_merged_prims_have_their_own_mattes(renderer: FrameRenderer) -> None:
    card = rectangle((0, 0, -3), (0.2, 0, 0), (0, 0.2, 0))
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = -0.7, 0.0, 0.7
    poses[2, 0, 0] = -1  # mirrored, so drawn apart from the others
    instances = Batch(
        replace(card, prim_ids=np.zeros(2, np.int32)),
        Material(),
        poses,
        double_sided=True,
        instance_prim_ids=np.array([1, 2, 1], np.int32),
        instance_material_ids=np.array([0, 1, -1], np.int32),
    )
    merged = replace(
        rectangle((0, 0.6, -3), (0.7, 0, 0), (0, 0.2, 0)),
        prim_ids=np.array([3, 4], np.int32),
        material_ids=np.array([1, -1], np.int32),
    )
    made = Scene(
        (instances, Batch(merged, Material(), HERE)),
        (),
        None,
        ("/kind", "/a", "/b", "/c", "/d"),
        material_paths=("/red", "/blue"),
    )
    settings = replace(SETTINGS, engine="pinhole", aovs=("color", "cryptoObject", "cryptoMaterial"))
    frame = renderer.render(made, CAMERA, settings)

    assert frame.matte_names == {
        "cryptoObject": ("/a", "/b", "/c", "/d"),
        "cryptoMaterial": ("/blue", "/red", "default"),
    }
    left, middle, right = (matte(frame, "/a")[:, columns] for columns in (np.s_[:40], np.s_[40:56], np.s_[56:]))
    assert left.sum() == pytest.approx(right.sum(), rel=0.05)
    assert middle.sum() == 0
    areas = {name: matte(frame, name, "cryptoMaterial").sum() for name in ("/red", "/blue", "default")}
    one_card, triangle = left.sum(), matte(frame, "/c").sum()
    assert areas["/red"] == pytest.approx(one_card, rel=0.02)
    assert areas["/blue"] == pytest.approx(matte(frame, "/b").sum() + triangle, rel=1e-5)
    assert areas["default"] == pytest.approx(right.sum() + matte(frame, "/d").sum(), rel=1e-5)
    np.testing.assert_allclose(total(frame, "cryptoMaterial"), frame.color[..., 3], atol=2e-6)


@pytest.mark.parametrize("engine", ["flag", "scatter", "gather", "linear", "importance", "accumulation"])
def test_engines_without_mattes_refuse_them(renderer: FrameRenderer, engine: str) -> None:
    with pytest.raises(SettingsError, match=f"the {engine} engine has no cryptoObject: take one of lens, pinhole"):
        renderer.render(scene(), CAMERA, replace(SETTINGS, engine=engine))
