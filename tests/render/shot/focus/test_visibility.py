"""Whether something stands before a place: what hides a focus point, and by how much."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.scene import Batch, Geometry, Image, Material, Scene, TextureLookup
from render.shot.focus.visibility import visible_shares

PINHOLE = Camera(world_from_camera=np.eye(4))
OPEN = replace(PINHOLE, f_stop=1.0)  # a pupil of 25 mm radius


def surface(positions: object, triangles: object, **more: object) -> Geometry:
    points, corners = np.array(positions, np.float32), np.array(triangles, np.int32)
    none = np.zeros(len(corners), np.int32)
    return Geometry(points, np.zeros_like(points), corners, none, none, none, **more)


def board(
    depth_m: float = 1.0, half_m: float = 0.5, *, x_m: float = 0.0, two_sided: bool = False, **material: object
) -> Batch:
    """A square that faces the camera, its texture upright."""
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    geometry = surface(
        np.column_stack([x_m + half_m * square[:, 0], half_m * square[:, 1], np.full(4, -depth_m)]),
        [[0, 1, 2], [0, 2, 3]],
        uvs=((square + 1) / 2).astype(np.float32),
    )
    return Batch(geometry, Material(**material), np.eye(4)[None], two_sided)


def seen(batches: tuple[Batch, ...], *places: tuple[float, float, float], camera: Camera = PINHOLE) -> list[float]:
    return visible_shares(Scene(batches), camera, np.array(places, np.float64)).tolist()


def test_what_stands_before_a_place_hides_it_and_nothing_else() -> None:
    places = [(0.2, 0.1, -2.0), (3.0, 0.0, -2.0), (0.2, 0.1, -0.5), (0.0, 0.0, -1.0)]
    assert seen((board(),), *places) == [0, 1, 1, 1]
    assert seen((), *places) == [1, 1, 1, 1]


def test_a_surface_does_not_hide_its_own_places() -> None:
    """Places all over a ball, found in double precision: those that face the eye are seen, those on the far side are not."""
    lon, lat = np.meshgrid(np.linspace(0, 2 * np.pi, 33)[:-1], np.linspace(-1.5708, 1.5708, 17))
    points = np.stack([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1).reshape(-1, 3)
    centre = np.array([700.0, 3.0, -40.0])
    row, column = np.meshgrid(np.arange(16), np.arange(32), indexing="ij")
    quad = np.stack([row, row, row + 1, row + 1], -1) * 32 + np.stack(
        [column, (column + 1) % 32, (column + 1) % 32, column], -1
    )
    triangles = np.concatenate([quad[..., [0, 1, 2]].reshape(-1, 3), quad[..., [0, 2, 3]].reshape(-1, 3)])
    ball = surface(points + centre, triangles)
    pose = np.eye(4)
    pose[:3, 3] = centre + np.array([0.3, 0.2, 9.0])
    corners = ball.positions[triangles].astype(np.float64)
    places = np.einsum("tcx,c->tx", corners, [0.2, 0.3, 0.5])
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facing = np.sum(normals * (pose[:3, 3] - places), axis=1)
    sizes = np.linalg.norm(normals, axis=1) * np.linalg.norm(pose[:3, 3] - places, axis=1)
    # not those at the poles, which are slivers, and not those at the limb, where a facet's own neighbours may stand before it
    clear = (sizes > 0.01) & (np.abs(facing) > 0.1 * sizes)
    visible = visible_shares(Scene((Batch(ball, Material(), np.eye(4)[None]),)), Camera(world_from_camera=pose), places)
    np.testing.assert_array_equal(visible[clear], (facing > 0)[clear])
    assert 0.3 < visible.mean() < 0.6
    assert clear.mean() > 0.7


def test_a_wide_lens_looks_around_what_is_narrower_than_its_pupil() -> None:
    """A post 20 mm wide in the middle, half way to the place, takes the part of the pupil within 20 mm of its centre line."""
    radius, half = 0.025, 0.02
    hidden = 2 * (np.arcsin(half / radius) + half / radius * np.sqrt(1 - (half / radius) ** 2)) / np.pi
    post = surface(
        [[-half / 2, -9, -1], [half / 2, -9, -1], [half / 2, 9, -1], [-half / 2, 9, -1]], [[0, 1, 2], [0, 2, 3]]
    )
    scene = Scene((Batch(post, Material(), np.eye(4)[None]),))
    place = np.array([[0.0, 0.0, -2.0]])
    assert visible_shares(scene, PINHOLE, place)[0] == 0
    assert visible_shares(scene, OPEN, place, rays=4000)[0] == pytest.approx(1 - hidden, abs=0.002)
    assert visible_shares(scene, OPEN, place)[0] == pytest.approx(1 - hidden, abs=0.07)
    assert visible_shares(scene, replace(OPEN, f_stop=4.0), place)[0] == 0


def test_a_place_is_taken_from_sight_little_by_little() -> None:
    """A board that slides before a place never takes more than a few of the pupil's places at a time."""
    edges = np.linspace(-0.02, 0.02, 41)
    shares = [
        visible_shares(Scene((board(x_m=float(x) - 0.5),)), OPEN, np.array([[0.0, 0.0, -2.0]]), rays=64)[0]
        for x in edges
    ]
    assert shares[0] == 1
    assert shares[-1] == 0
    steps = np.diff(shares)
    assert (steps <= 0).all()
    assert -steps.min() < 0.1


@pytest.mark.parametrize(
    ("material", "through"),
    [
        ({"opacity": 0.25}, 0.75),
        ({"opacity": 0.0}, 1.0),
        ({"opacity": 0.25, "opacity_threshold": 0.5}, 1.0),
        ({"opacity": 0.75, "opacity_threshold": 0.5}, 0.0),
    ],
)
def test_glass_dims_and_cut_outs_have_holes(material: dict[str, float], through: float) -> None:
    # the place lies behind the edge that the square's two triangles share, which is one surface
    assert seen((board(**material),), (0.0, 0.0, -2.0), (0.1, 0.0, -2.0)) == [through, through]
    assert seen((board(**material), board(1.5, **material)), (0.1, 0.0, -2.0)) == [pytest.approx(through**2)]


def test_a_leafs_texture_says_where_it_is_there() -> None:
    """Red in the top left quarter alone: what is looked up there hides, the rest is a hole."""
    pixels = np.zeros((4, 4, 4), np.float16)
    pixels[:2, :2, 0] = 1
    leaf = board(lookups={"opacity": TextureLookup(Image(pixels), channel=0)}, opacity_threshold=0.5)
    assert seen((leaf,), *((x, y, -2.0) for y in (0.5, -0.5) for x in (-0.5, 0.5))) == [0, 1, 1, 1]


@pytest.mark.parametrize(("wrap", "at"), [("repeat", 0), ("clamp", 1), ("mirror", 1), ("black", 0)])
def test_a_leafs_texture_wraps(wrap: str, at: int) -> None:
    """Only the rightmost texel is there, and what is looked up lies a little beyond the right edge."""
    pixels = np.zeros((1, 4, 4), np.float16)
    pixels[0, 3] = 1
    further = np.array([[1, 0, 0.6], [0, 1, 0]], np.float32)
    leaf = board(
        lookups={"opacity": TextureLookup(Image(pixels), uv_transform=further, wrap_s=wrap, wrap_t="clamp", channel=3)}
    )
    assert seen((leaf,), (0.0, 0.0, -2.0)) == [1 - at]


def test_display_opacity_counts_where_the_material_says_so() -> None:
    glass = board(uses_display_color=True)
    colours = np.array([[1, 1, 1, 0.5]] * 4, np.float32)
    glass = replace(glass, geometry=replace(glass.geometry, colors=colours))
    assert seen((glass,), (0.1, 0.0, -2.0)) == [pytest.approx(0.5)]
    assert seen((replace(glass, material=Material()),), (0.1, 0.0, -2.0)) == [0]


def test_backs_hide_only_where_they_are_drawn() -> None:
    turned = np.diag([-1.0, 1, -1, 1])[None]
    turned[0, 2, 3] = -2
    mirrored = np.diag([-1.0, 1, 1, 1])[None]
    away = board()
    place = (0.1, 0.1, -3.0)
    assert seen((replace(away, poses=turned),), place) == [1]
    assert seen((replace(away, poses=turned, double_sided=True),), place) == [0]
    assert seen((replace(away, poses=mirrored),), place) == [0]


def test_what_is_nearer_than_the_clipping_range_is_not_there() -> None:
    near = board(0.05)
    assert seen((near,), (0.0, 0.1, -2.0)) == [0]
    assert seen((near,), (0.0, 0.1, -2.0), camera=replace(PINHOLE, near_m=0.06)) == [1]


def test_places_that_are_not_before_the_camera_are_not_seen() -> None:
    nan = float("nan")
    assert seen((), (0, 0, 1.0), (nan, 0, -1.0), (0, 0, -0.005), (0, 0, 0)) == [0, 0, 0, 0]
    assert visible_shares(Scene((board(),)), OPEN, np.empty((0, 3))).shape == (0,)


def test_instances_occlude_where_they_stand_and_flat_ones_nothing() -> None:
    poses = np.tile(np.eye(4), (300, 1, 1))
    poses[:, 0, 3] = 3.0 * np.arange(300)
    poses[5, 2, 2] = 0
    batch = replace(board(), poses=poses)
    behind = [(2 * 3.0 * i, 0.2, -2.0) for i in (0, 1, 4, 5, 299)]
    between = [(2 * (3.0 * i + 1.5), 0.2, -2.0) for i in (0, 299)]
    assert seen((batch, board(4)), *behind, *between) == [0, 0, 0, 1, 0, 1, 1]


@pytest.mark.parametrize("count", [1, 7, 8, 9, 33, 2000])
@pytest.mark.parametrize("two_sided", [True, False])
def test_agrees_with_every_triangle_tried_in_turn(count: int, two_sided: bool) -> None:
    rng = np.random.default_rng(count)
    middles = rng.uniform([-2, -2, -9], [2, 2, -1], (count, 1, 3))
    corners = (middles + rng.uniform(-4, 4, (count, 3, 3)) / np.cbrt(count)).astype(np.float32).reshape(-1, 3)
    geometry = surface(corners, np.arange(3 * count).reshape(-1, 3))
    poses = np.stack([np.eye(4), np.eye(4)])
    poses[1, :3] = [[0.4, -0.9, 0, 0.5], [0.9, 0.4, 0.1, 0], [0, 0.2, -1.5, -12.0]]
    camera = replace(OPEN, f_stop=0.2)
    scene = Scene((Batch(geometry, Material(), poses, two_sided),))
    places = rng.uniform([-2, -2, -12], [2, 2, -2], (60, 3))
    expected = [every_triangle(scene.batches[0], pupil(camera, 16), place, camera) for place in places]
    np.testing.assert_allclose(visible_shares(scene, camera, places), expected)
    assert count < 33 or 0.02 < np.mean(expected) < 0.98


def pupil(camera: Camera, rays: int) -> DoubleArray:
    count = np.arange(rays)
    out = camera.focal_length_mm / 2000 / camera.f_stop * np.sqrt((count + 0.5) / rays)
    turn = count * np.pi * (3 - np.sqrt(5))
    return np.stack([out * np.cos(turn), out * np.sin(turn), np.zeros(rays)], axis=1)


def every_triangle(batch: Batch, starts: DoubleArray, place: DoubleArray, camera: Camera) -> float:
    """Share of the starts that see a place, by solving start + t·way = a + u·ab + v·ac for each triangle of each instance."""
    free = []
    for start in starts:
        hidden = False
        for pose in batch.poses:
            local = batch.geometry.positions.astype(np.float64) @ pose[:3, :3].T + pose[:3, 3]
            a, b, c = np.moveaxis(local[batch.geometry.triangles], 1, 0)
            columns = np.stack([b - a, c - a, np.broadcast_to(start - place, a.shape)], axis=2)
            u, v, t = np.linalg.solve(columns, (start - a)[..., None])[..., 0].T
            front = np.sum(np.cross(b - a, c - a) * (start - place), axis=1) * np.linalg.det(pose[:3, :3]) > 0
            inside = (u >= 0) & (v >= 0) & (u + v <= 1) & (t * -place[2] >= camera.near_m) & (t < 1 - 1.2e-4)
            hidden |= bool((inside & (front | batch.double_sided)).any())
        free.append(not hidden)
    return float(np.mean(free))


@given(
    turn=st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda q: np.linalg.norm(q) > 0.1),
    move=st.tuples(*[st.floats(-50, 50)] * 3),
)
def test_moving_scene_and_camera_together_changes_nothing(turn: tuple[float, ...], move: tuple[float, ...]) -> None:
    rigid = np.eye(4)
    rigid[:3, :3], rigid[:3, 3] = rotation(np.array(turn) / np.linalg.norm(turn)), move
    batches = (board(), board(1.5, 0.3, x_m=1.0, opacity=0.5), board(2.5, 2.0, x_m=-2.0))
    places = np.array([(0.2, 0.1, -2.0), (1.35, 0.1, -2.0), (-1.9, 0.3, -3.0), (0.3, 1.2, -2.1), (0.0, -0.4, -0.8)])
    here = visible_shares(Scene(batches), OPEN, places)
    moved = Scene(tuple(replace(b, poses=rigid @ b.poses) for b in batches))
    there = visible_shares(moved, replace(OPEN, world_from_camera=rigid), places @ rigid[:3, :3].T + rigid[:3, 3])
    np.testing.assert_allclose(there, here)
    assert here.tolist() == [0, 0.5, 0, 1, 1]


def rotation(q: NDArray[np.float64]) -> DoubleArray:
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
