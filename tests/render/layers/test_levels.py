"""Simpler levels of meshes: their distance from the mesh, their seams, borders and size, and the sketches that draw them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from threading import Event

import numpy as np
import pytest
from numpy.typing import NDArray

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.metrics import psnr_db
from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.levels.maker import LevelMaker
from render.layers.levels.simplify import LEAST_TRIANGLES, MOST_TRIANGLES, Levels, cut_sections, make_levels
from render.layers.levels.sketch_index import MOST_ERROR_PX
from render.layers.peel import SKETCH
from render.layers.peeled import Layers
from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Geometry, Light, Material, Scene
from render.optics.view import PinholeView
from render.trace.rays import make_ray_pattern


def ball(rings: int, *, waves: float = 0.05) -> Geometry:
    """A closed ball of 1 m with waves on it, of ``4 · rings²`` triangles; texture coordinates have a seam along a meridian."""
    turn, height = np.meshgrid(np.linspace(0, 1, 2 * rings + 1), np.linspace(0, 1, rings + 1))
    a, b = 2 * np.pi * (turn % 1.0), np.pi * height
    r = 1 + waves * np.sin(5 * a) * np.sin(4 * b)
    points = np.stack([r * np.sin(b) * np.cos(a), r * np.cos(b), r * np.sin(b) * np.sin(a)], -1)
    points[0], points[-1] = points[0, 0], points[-1, 0]
    columns = 2 * rings + 1
    first = (np.arange(rings)[:, None] * columns + np.arange(2 * rings)).ravel()
    upper = np.stack([first, first + 1, first + columns + 1], 1)
    lower = np.stack([first, first + columns + 1, first + columns], 1)
    triangles = np.stack([upper, lower], 1).reshape(-1, 3).astype(np.int32)
    flat = points.reshape(-1, 3)
    count = len(triangles)
    return Geometry(
        flat.astype(np.float32),
        (flat / np.linalg.norm(flat, axis=1, keepdims=True)).astype(np.float32),
        triangles,
        np.zeros(count, np.int32),
        np.arange(count, dtype=np.int32),
        np.zeros(count, np.int32),
        np.stack([turn, height], -1).reshape(-1, 2).astype(np.float32),
    )


def levels_of(geometry: Geometry) -> Levels:
    levels = make_levels(geometry)
    assert levels is not None
    return levels


def triangles_at(levels: Levels, section: int, error_m: float) -> IntArray:
    """Vertices ``(t, 3)`` of a section's level, without the triangles that fill its last cluster."""
    own = (levels.section == section) & (levels.error_m == error_m)
    chosen = levels.geometry.triangles[np.repeat(own, CLUSTER_TRIANGLES)]
    return chosen[(chosen != chosen[:, :1]).any(axis=1)]


def distances(points: DoubleArray, corners: DoubleArray) -> DoubleArray:
    """Distance of each of ``(n, 3)`` points from the nearest of ``(t, 3, 3)`` triangles."""
    a, edges = corners[:, 0], corners[:, 1:] - corners[:, :1]
    gram = edges @ edges.transpose(0, 2, 1)
    inverse = np.linalg.pinv(gram)
    found = []
    for point in points:
        share = np.einsum("tij,tjx,tx->ti", inverse, edges, point - a)
        inside = (share >= 0).all(1) & (share.sum(1) <= 1)
        on_plane = np.linalg.norm(a + np.einsum("ti,tix->tx", share, edges) - point, axis=1)
        nearest = on_plane[inside].min(initial=np.inf)
        for i in range(3):
            start, along = corners[:, i], corners[:, (i + 1) % 3] - corners[:, i]
            at = np.clip(np.sum((point - start) * along, 1) / np.maximum(np.sum(along**2, 1), 1e-30), 0, 1)
            nearest = min(nearest, np.linalg.norm(start + at[:, None] * along - point, axis=1).min())
        found.append(nearest)
    return np.array(found)


def points_on(corners: DoubleArray, count: int) -> DoubleArray:
    """Random points on some of ``(t, 3, 3)`` triangles."""
    random = np.random.default_rng(1)
    shares = random.dirichlet([1, 1, 1], count)
    return np.einsum("ni,nix->nx", shares, corners[random.integers(0, len(corners), count)])


@pytest.mark.parametrize("waves", [0.0, 0.05])
def test_no_level_is_farther_from_its_mesh_than_its_error(waves: float) -> None:
    geometry = ball(34, waves=waves)
    levels = levels_of(geometry)
    whole = geometry.positions[geometry.triangles].astype(float)
    errors = np.unique(levels.error_m)
    assert len(errors) >= 2
    for error_m in errors:
        corners = levels.geometry.positions[triangles_at(levels, 0, error_m)].astype(float)
        assert distances(points_on(whole, 40), corners).max() <= error_m
        assert distances(points_on(corners, 40), whole).max() <= error_m


def test_levels_have_fewer_triangles_and_vertices_than_the_mesh() -> None:
    geometry = ball(40)
    levels = levels_of(geometry)
    assert len(levels.geometry.triangles) < len(geometry.triangles)
    assert len(levels.geometry.positions) < len(geometry.positions)
    sizes = [len(triangles_at(levels, 0, error_m)) for error_m in np.unique(levels.error_m)]
    assert all(2 * after <= before for before, after in zip([len(geometry.triangles), *sizes], sizes, strict=False))


def test_the_same_mesh_has_the_same_levels() -> None:
    one, other = levels_of(ball(36)), levels_of(ball(36))
    for name in ("positions", "normals", "uvs", "triangles"):
        assert np.array_equal(getattr(one.geometry, name), getattr(other.geometry, name))
    assert np.array_equal(one.error_m, other.error_m)


def test_seams_of_texture_coordinates_stay() -> None:
    levels = levels_of(ball(40))
    uvs = levels.geometry.uvs
    assert uvs is not None
    spans = np.ptp(uvs[levels.geometry.triangles][..., 0], axis=1)
    corners = levels.geometry.positions[levels.geometry.triangles]
    away_from_poles = (np.hypot(corners[..., 0], corners[..., 2]) > 0.4).all(1)
    assert spans[away_from_poles].max() < 0.5


def test_sections_at_different_levels_leave_no_gap() -> None:
    geometry = ball(110)
    ends = cut_sections(geometry.prim_ids)
    assert len(ends) == 2
    assert ends[0] == MOST_TRIANGLES
    levels = levels_of(geometry)
    coarsest = levels.error_m[levels.section == 0].max()
    simple = levels.geometry.positions[triangles_at(levels, 0, coarsest)]
    corners = np.concatenate([simple, geometry.positions[geometry.triangles[ends[0] :]]])
    assert len(simple) < MOST_TRIANGLES / 4
    _, point = np.unique(np.round(corners.reshape(-1, 3), 5), axis=0, return_inverse=True)
    triangles = point.reshape(-1, 3)
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    edges = edges[edges[:, 0] != edges[:, 1]]
    _, uses = np.unique(edges, axis=0, return_counts=True)
    assert (uses % 2 == 0).all()


def test_sections_end_with_prims_and_clusters() -> None:
    prims = np.repeat(np.arange(3), [5_000, 5_000, 40_000])
    ends = cut_sections(prims)
    assert ends == [4_992, 5_056, 9_984, 10_048, 10_048 + MOST_TRIANGLES, 50_000]
    assert cut_sections(np.zeros(10, int)) == [10]


def test_thin_things_stay_whole() -> None:
    """Blades of grass, each a triangle of 5 mm by 0.2 m: a coarser level would lose them."""
    random = np.random.default_rng(3)
    foot = np.concatenate(
        [random.uniform(-2, 2, (3_000, 1)), np.zeros((3_000, 1)), random.uniform(-2, 2, (3_000, 1))], 1
    )
    blades = np.stack([foot, foot + np.array([0.005, 0, 0]), foot + np.array([0.0025, 0.2, 0.01])], 1).reshape(-1, 3)
    triangles = np.arange(len(blades), dtype=np.int32).reshape(-1, 3)
    none = np.zeros(len(triangles), np.int32)
    geometry = Geometry(
        blades.astype(np.float32), np.tile([0, 0, 1], (len(blades), 1)).astype(np.float32), triangles, none, none, none
    )
    doubled = replace(geometry, triangles=np.concatenate([triangles, triangles[:, ::-1]]), prim_ids=np.tile(none, 2))
    assert len(doubled.triangles) >= LEAST_TRIANGLES
    assert make_levels(doubled) is None


def test_small_and_stale_geometries_have_no_levels() -> None:
    assert make_levels(ball(16)) is None
    assert make_levels(ball(40), lambda: True) is None


def place(x: float, z: float, scale: float = 1.0) -> DoubleArray:
    pose = np.diag([scale, scale, scale, 1.0])
    pose[:3, 3] = x, 0, z
    return pose


CAMERA = Camera(np.eye(4), 36, 36, 20.25, f_stop=4.0, focus_distance_m=9.0, near_m=0.1, far_m=200.0)
VIEW = PinholeView.from_camera(CAMERA, 192, 108)
BALL = ball(90)


def scene_of(material: Material, *poses: DoubleArray, geometry: Geometry = BALL) -> Scene:
    light = Light("distant", (2.0, 2.0, 2.0), np.eye(4), angle_rad=0.01)
    return Scene((Batch(geometry, material, np.stack(poses)),), (light,), Dome((0.3, 0.3, 0.4), np.eye(4)), ("/ball",))


PLAIN = Material(base_color=(0.7, 0.4, 0.2), roughness=0.6)
FAR = scene_of(PLAIN, place(-2, -9), place(2.5, -14), place(-3, -25, 2.0), place(3, -8) @ np.diag([-1.0, 1, 1, 1]))


SETTINGS = FrameSettings(192, 108, rays=16)


def sketch(renderer: FrameRenderer, scene: Scene) -> tuple[Layers, FloatArray]:
    """A sketch that is drawn anew, with the levels that are ready."""
    device = renderer.device
    with renderer.on_device():
        camera = renderer.load(scene, CAMERA, SETTINGS, is_preview=True)
        device.peeler.clear_cache()
        peeled, view = device.previewer.peel(device.peeler, camera, VIEW, unlit=False, sketch="always")
        pattern = make_ray_pattern(16, camera.iris, seed=1, tiled=False)
        return peeled, device.previewer.trace(device.peeler, peeled, camera, view, pattern, 1).copy()


def triangles_drawn(renderer: FrameRenderer, peeled: Layers) -> int:
    sketches = renderer.device.peeler.sketches
    chosen = sketches.choose(peeled.view)
    every: NDArray[np.intp] = np.arange(len(sketches.clusters.members()[0])) if chosen is None else chosen
    return int(sketches.clusters.triangle_counts(every).sum())


@pytest.mark.gl
def test_sketches_draw_levels_and_pictures_do_not(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    before = renderer.render(FAR, CAMERA, SETTINGS).color
    sketches = renderer.device.peeler.sketches
    monkeypatch.setattr(sketches, "most_error_px", 0.0)
    peeled, whole = sketch(renderer, FAR)
    in_view = triangles_drawn(renderer, peeled)
    sketch(renderer, FAR)
    sketches.maker.wait()
    peeled, same = sketch(renderer, FAR)
    assert np.array_equal(same, whole), "an error of 0 px draws the whole mesh"
    monkeypatch.setattr(sketches, "most_error_px", MOST_ERROR_PX)
    peeled, simple = sketch(renderer, FAR)
    assert peeled.nearest_w is not None
    assert triangles_drawn(renderer, peeled) < in_view / 2
    assert psnr_db(simple, whole) > 30
    assert not np.array_equal(simple, whole)
    assert np.array_equal(sketch(renderer, FAR)[1], simple)
    after = renderer.render(FAR, CAMERA, SETTINGS).color
    assert np.array_equal(after, before)


@pytest.mark.gl
def test_levels_follow_what_moves(renderer: FrameRenderer) -> None:
    """Moved instances of the same mesh keep its levels, on the way and back."""
    sketches = renderer.device.peeler.sketches
    sketch(renderer, FAR)
    sketch(renderer, FAR)
    sketches.maker.wait()
    _, first = sketch(renderer, FAR)
    moved = scene_of(PLAIN, place(1, -9), place(-2.5, -14), place(0, -30, 2.0))
    peeled, _ = sketch(renderer, moved)
    assert triangles_drawn(renderer, peeled) < 3 * len(BALL.triangles) / 2
    assert np.array_equal(sketch(renderer, FAR)[1], first)


@pytest.mark.gl
def test_near_meshes_are_drawn_whole(renderer: FrameRenderer) -> None:
    near = scene_of(PLAIN, place(0, -1.2))
    for _ in range(2):
        sketch(renderer, near)
    renderer.device.peeler.sketches.maker.wait()
    peeled, _ = sketch(renderer, near)
    assert triangles_drawn(renderer, peeled) == len(BALL.triangles)


@pytest.mark.gl
def test_what_may_be_transparent_or_bends_has_no_levels(renderer: FrameRenderer) -> None:
    sketches = renderer.device.peeler.sketches
    glass = scene_of(replace(PLAIN, opacity=0.5), place(0, -20))
    for _ in range(3):
        sketch(renderer, glass)
        sketches.maker.wait()
    assert sketches.choose(VIEW) is None
    for i in range(3):
        sketch(renderer, scene_of(PLAIN, place(0, -20), geometry=ball(34, waves=0.01 * i)))
        sketches.maker.wait()
        assert sketches.maker.made() == {}


@pytest.mark.gl
def test_pictures_of_the_sketch_slot_alone_are_sketches(renderer: FrameRenderer) -> None:
    with renderer.on_device():
        camera = renderer.load(FAR, CAMERA, SETTINGS)
        device = renderer.device
        small, _ = device.previewer.peel(device.peeler, camera, VIEW, unlit=True, sketch="always")
        wide, _ = device.previewer.peel(device.peeler, camera, VIEW, unlit=True, sketch="never")
        assert small.nearest_w is not None
        assert wide.nearest_w is None
        assert device.peeler.has_layers(small.view, unlit=True, cache_slot=SKETCH)


def test_a_paused_maker_waits_until_it_may_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    begun, polled = Event(), []

    def make(geometry: Geometry, is_stale: Callable[[], bool]) -> None:
        begun.set()
        polled.append(is_stale())

    monkeypatch.setattr("render.layers.levels.maker.make_levels", make)
    maker = LevelMaker()
    maker.pause(is_paused=True)
    maker.want([ball(4)])
    assert begun.wait(10)
    assert polled == []
    maker.wait()
    assert polled == [False]
    maker.pause(is_paused=True)
    begun.clear()
    maker.want([ball(5)])
    assert begun.wait(10)
    maker.release()  # ends the thread, which would keep the process otherwise
