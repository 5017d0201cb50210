"""Clusters: what is left out of a pass would have left no fragment in it, and little more is drawn than that."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.frame import FrameRenderer, FrameSettings
from render.lab.reference.scenes import sphere
from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.clusters import ClusterIndex, cut_clusters
from render.layers.hidden import TILE_PX, HiddenTiles
from render.model.arrays import DoubleArray, IndexArray
from render.model.camera import Camera
from render.model.scene import Batch, Geometry, Light, Material, Scene
from render.optics.view import PinholeView

VIEW = PinholeView.from_camera(Camera(np.eye(4), 36, 36, 27, near_m=0.1, far_m=100.0), 320, 240)
CLIP = VIEW.projection_matrix() @ VIEW.camera_from_world
BALL = sphere((0, 0, 0), 1.0)
FLOOR = Geometry(
    np.array([[-20, -1, 5], [20, -1, 5], [20, -1, -30], [-20, -1, -30]], np.float32),
    np.tile(np.array([0, 1, 0], np.float32), (4, 1)),
    np.array([[0, 1, 2], [0, 2, 3]], np.int32),
    *(np.zeros(2, np.int32) for _ in range(3)),
)


@dataclass(frozen=True)
class SomeDraw:
    """A draw without a device."""

    batch: Batch
    instances: IndexArray
    has_backs: bool = False


def place(x: float, y: float, z: float, scale: float = 1.0) -> DoubleArray:
    pose = np.diag([scale, scale, scale, 1.0])
    pose[:3, 3] = x, y, z
    return pose


def index_of(*poses: DoubleArray) -> ClusterIndex:
    index = ClusterIndex()
    batch = Batch(BALL, Material(), np.stack(poses))
    index.update([SomeDraw(batch, np.arange(len(poses)))])
    return index


def triangles_of(index: ClusterIndex, clusters: IndexArray) -> list[tuple[int, int]]:
    """Instance and number of every triangle that is drawn, in the order of drawing."""
    return [
        (instance, triangle)
        for share in index.ranges(clusters).get(0, [])
        for instance in range(share.first_instance, share.first_instance + share.instances)
        for triangle in range(share.first_triangle, share.first_triangle + share.triangles)
    ]


def test_clusters_hold_their_triangles_and_normals() -> None:
    own = cut_clusters(BALL, cones=True)
    for i, first in enumerate(range(0, len(BALL.triangles), CLUSTER_TRIANGLES)):
        points = BALL.positions[BALL.triangles[first : first + CLUSTER_TRIANGLES]]
        assert (points.min((0, 1)) == own.low[i]).all()
        assert (points.max((0, 1)) == own.high[i]).all()
        normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
        length = np.linalg.norm(normals, axis=1)
        inner = (normals @ own.axis[i])[length > 0] / length[length > 0]
        assert (inner >= own.spread[i, 0]).all() or own.spread[i, 0] == 0
    assert own.spread[:, 0].max() > 0.5, "some cones are narrow"


@given(st.floats(-6, 6), st.floats(-6, 6), st.floats(-12, 3), st.floats(0.05, 3))
def test_every_triangle_in_view_that_faces_it_is_drawn(x: float, y: float, z: float, scale: float) -> None:
    index = index_of(place(x, y, z, scale))
    clusters = index.select(CLIP, eye=np.zeros(3))
    drawn = {triangle for _, triangle in triangles_of(index, clusters)}
    corners = (BALL.positions * scale + [x, y, z])[BALL.triangles]
    pixels, depth = VIEW.project(corners.reshape(-1, 3).astype(float))
    inside = (depth > 0.1) & (depth < 100) & (pixels > 0).all(1) & (pixels < [320, 240]).all(1)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    faces = np.sum(normals * corners[:, 0], axis=1) < -1e-9  # those at the poles have no area
    assert set(np.flatnonzero(inside.reshape(-1, 3).any(1) & faces).tolist()) <= drawn


def test_what_faces_away_or_lies_beside_is_left_out() -> None:
    ahead = index_of(place(0, 0, -5))
    whole = len(BALL.triangles)
    assert len(triangles_of(ahead, ahead.select(CLIP))) == whole
    assert len(triangles_of(ahead, ahead.select(CLIP, eye=np.zeros(3)))) < whole
    beneath, above = np.array([0.0, -60.0, -5.0]), np.array([0.0, 60.0, -5.0])
    for has_backs, eye, count in ((False, beneath, 0), (False, above, 2), (True, beneath, 2)):
        floor = ClusterIndex()
        floor.update([SomeDraw(Batch(FLOOR, Material(), np.eye(4)[None]), np.arange(1), has_backs)])
        assert len(triangles_of(floor, floor.select(CLIP, eye=eye))) == count
    for x, y, z in ((9, 0, -5), (0, -8, -5), (0, 0, 3), (0, 0, -120)):
        beside = index_of(place(x, y, z))
        assert triangles_of(beside, beside.select(CLIP)) == [], (x, y, z)
    around = index_of(place(0, 0, 0, 5.0))
    assert triangles_of(around, around.select(CLIP)), "the camera stands in it"


def test_ranges_follow_the_order_of_drawing() -> None:
    index = index_of(*(place(3.0 * i - 6, 0, -5) for i in range(5)))
    drawn = triangles_of(index, index.select(CLIP, eye=np.zeros(3)))
    assert drawn == sorted(set(drawn))
    assert {instance for instance, _ in drawn} == {1, 2, 3}


def test_uneven_scale_leaves_no_facing_triangle_out() -> None:
    pose = place(0, 0, -5) @ np.diag([3.0, 0.2, 1.0, 1.0])
    index = index_of(pose)
    assert len(triangles_of(index, index.select(CLIP, eye=np.zeros(3)))) == len(BALL.triangles)


@given(st.integers(0, 2**32 - 1))
def test_rectangles_are_hidden_only_where_every_pixel_hides_them(seed: int) -> None:
    random = np.random.default_rng(seed)
    rows, columns = random.integers(1, 14, 2)
    limits = random.choice([-1.0, 0.0, 0.5, 2.0], (rows, columns)).astype(np.float32)
    low = random.uniform(-20, (columns * TILE_PX, rows * TILE_PX), (40, 2))
    high = low + random.uniform(0, 60, (40, 2))
    w = random.uniform(0, 2.5, 40)
    hidden = HiddenTiles(limits).hide(low, high, w)
    last = np.array([columns - 1, rows - 1])
    for i in range(40):
        left, top = np.clip(low[i] // TILE_PX, 0, last).astype(int)
        right, bottom = np.clip(high[i] // TILE_PX, 0, last).astype(int)
        if hidden[i]:
            assert w[i] >= limits[top : bottom + 1, left : right + 1].max()
    assert HiddenTiles(np.full((rows, columns), -1, np.float32)).hide(low, high, w).all()


@pytest.fixture(scope="module")
def renderer() -> Iterator[FrameRenderer]:
    with FrameRenderer() as made:
        yield made


def busy_scene() -> tuple[Scene, Camera]:
    """Balls behind each other, some transparent, some mirrored, some beside the view, above a floor."""
    random = np.random.default_rng(5)
    poses = np.stack([place(*random.uniform((-4, -1, -14), (4, 2, 2)), random.uniform(0.2, 0.8)) for _ in range(60)])
    poses[::3, :3, 0] *= -1
    glass, white = Material("glass", opacity=0.4), Material("white", base_color=(0.8, 0.5, 0.3))
    batches = (
        Batch(BALL, white, poses[:40]),
        Batch(BALL, glass, poses[40:50]),
        Batch(BALL, white, poses[50:], double_sided=True),
        Batch(FLOOR, white, np.eye(4)[None]),
    )
    light = Light("sphere", (60.0, 60.0, 50.0), place(2, 6, -2), radius_m=0.2)
    camera = Camera(np.eye(4), 36, 36, 27, f_stop=0.9, focus_distance_m=5.0, near_m=0.1, far_m=200.0)
    return Scene(batches, (light,), prim_paths=("/ball",)), camera


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["lens", "pinhole"])
def test_pictures_are_equal_with_and_without_clusters(
    engine: str, renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene, camera = busy_scene()
    settings = FrameSettings(96, 72, engine=engine, rays=8, layers=4, aovs=("color", "prim_id", "face_id"))
    culled = renderer.render(scene, camera, settings)

    def all_clusters(index: ClusterIndex, *_: object, **__: object) -> IndexArray:
        return np.arange(len(index._owner))

    def nothing(_: HiddenTiles, low: DoubleArray, *__: object) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
        return np.zeros(len(low), bool)

    monkeypatch.setattr(ClusterIndex, "select", all_clusters)
    monkeypatch.setattr(HiddenTiles, "hide", nothing)
    with FrameRenderer() as other:
        whole = other.render(scene, camera, settings)
    assert (culled.color == whole.color).all()
    assert all((culled.aovs[name] == whole.aovs[name]).all() for name in ("prim_id", "face_id"))
    assert culled.color[..., :3].std() > 0.01


@pytest.mark.gl
def test_later_layers_draw_few_triangles(renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, camera = busy_scene()
    drawn: list[int] = []
    ranges = ClusterIndex.ranges

    def counted(index: ClusterIndex, clusters: IndexArray) -> object:
        found = ranges(index, clusters)
        drawn.append(sum(share.triangles * share.instances for shares in found.values() for share in shares))
        return found

    monkeypatch.setattr(ClusterIndex, "ranges", counted)
    renderer.forget_layers()
    renderer.render(scene, camera, FrameSettings(96, 72, rays=4, layers=4, supersample=4))  # without a sharp layer
    layers = drawn[-4:]
    assert layers[0] < 0.8 * scene.triangle_count
    assert layers[1] < layers[0]
    assert layers[3] < 0.7 * layers[0]
