"""Subdivision surfaces against closed forms and OpenSubdiv's figures: limit positions, creases, borders, primvars, places."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from render.model.arrays import DoubleArray
from render.model.face_places import fans_of_places, place_in_fan
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, check
from render.stage.geometry.subdivision.limit_places import LimitPlaces
from render.stage.geometry.subdivision.refinement import Cage, Refinement
from render.stage.geometry.subdivision.topology import INFINITE, Sharpness

CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]


OPEN = [[0, 0, 0], [2, 0, 0.3], [3, 1.5, 0], [1, 3, 0.5], [-1, 1.5, 0], [4, 0, 1], [1, 5, 0]]
OPEN_FACES = [[0, 1, 2, 3, 4], [1, 5, 2], [4, 3, 6]]
OPEN_TRIANGLES = [[0, 1, 2], [1, 5, 2], [0, 2, 3], [0, 3, 4], [4, 3, 6]]


def polygons_of(points: object, faces: list[list[int]], holes: list[int] | None = None) -> Polygons:
    counts = np.array([len(face) for face in faces], np.int32)
    hidden = None if holes is None else np.array(holes, np.int32)
    return Polygons(np.array(points, np.float32), counts, np.concatenate(faces).astype(np.int32), holes=hidden)


def cube() -> Polygons:
    return polygons_of(CUBE, CUBE_FACES)


def sharpness(creases: dict[tuple[int, int], float], corners: dict[int, float] | None = None) -> Sharpness:
    corners = corners or {}
    return Sharpness(
        np.array(list(creases), np.int64).reshape(-1, 2),
        np.array(list(creases.values())),
        np.array(list(corners), np.int64),
        np.array(list(corners.values())),
    )


def grid(n: int, cells: bool = True) -> tuple[DoubleArray, list[list[int]]]:
    """Points ``(n², 2)`` of a square grid, and its quads; else the two triangles of each."""
    points = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 2).astype(np.float64)
    first = [i * n + j for i in range(n - 1) for j in range(n - 1)]
    if cells:
        return points, [[i, i + n, i + n + 1, i + 1] for i in first]
    return points, [face for i in first for face in ([i, i + n, i + n + 1], [i, i + n + 1, i + 1])]


@pytest.mark.parametrize("levels", [1, 2, 4])
def test_a_grid_of_quads_is_a_bicubic_spline(levels: int) -> None:
    """A uniform cubic B-spline makes (x² + 1/3) y of control values x²y; a straight border stays where it is."""
    flat, faces = grid(8)
    heights = flat[:, 0] ** 2 * flat[:, 1]
    refined = Refinement(Cage(), polygons_of(np.column_stack([flat, heights]), faces), levels).refine()
    check(refined)
    assert len(refined.counts) == len(faces) * 4**levels
    x, y, z = refined.points.astype(np.float64).T
    inside = (x >= 2) & (x <= 5) & (y >= 2) & (y <= 5)  # of spans that no border bends
    np.testing.assert_allclose(z[inside], ((x**2 + 1 / 3) * y)[inside], atol=1e-5 * heights.max())
    np.testing.assert_allclose([x.min(), x.max(), y.min(), y.max()], [0, 7, 0, 7], atol=1e-6)


def test_triangles_of_loop_are_a_box_spline() -> None:
    """A quartic box spline makes x² + c of control values x², with the second moment c of its weights: 1/2 and six times 1/12."""
    flat, faces = grid(10, cells=False)
    refined = Refinement(Cage("loop"), polygons_of(np.column_stack([flat, flat[:, 0] ** 2]), faces), 3).refine()
    check(refined)
    x, y, z = refined.points.astype(np.float64).T
    inside = (x >= 3) & (x <= 6) & (y >= 3) & (y <= 6)
    np.testing.assert_allclose(z[inside], x[inside] ** 2 + 4 / 12, atol=1e-4)


def test_bilinear_surfaces_go_through_their_points() -> None:
    square = polygons_of([[0, 0, 0], [1, 0, 0], [1, 1, 1], [0, 1, 0]], [[0, 1, 2, 3]])
    x, y, z = Refinement(Cage("bilinear"), square, 3).refine().points.T
    np.testing.assert_allclose(z, x * y, atol=1e-6)


def test_a_cube_has_its_limit() -> None:
    """(n²v + 4Σe + Σf) / (n (n + 5)) with n = 3."""
    np.testing.assert_allclose(Refinement(Cage(), cube(), 1).refine().points[:8], CUBE / 2, atol=1e-6)


MIXED = {(0, 1): 2.5, (1, 3): 0.9, (1, 5): INFINITE}


@pytest.mark.parametrize(
    ("polygons", "cage"),
    [
        (cube(), Cage()),
        (cube(), Cage(sharpness=sharpness(MIXED, {7: 1.6}))),
        (polygons_of(OPEN, OPEN_FACES), Cage(border="edgeOnly", sharpness=sharpness({(1, 2): 3.3}))),
        (polygons_of(OPEN, OPEN_TRIANGLES), Cage("loop", sharpness=sharpness({(2, 3): 1.2, (0, 3): INFINITE}))),
    ],
    ids=["plain", "creases end", "open", "loop"],
)
def test_points_of_each_level_are_on_the_same_limit_surface(polygons: Polygons, cage: Cage) -> None:
    """Points keep their numbers from step to step; a point of the limit surface stays where it is."""
    levels = [Refinement(cage, polygons, level).refine().points for level in (1, 2, 3, 5)]
    for coarse, fine in pairwise(levels):
        np.testing.assert_allclose(fine[: len(coarse)], coarse, atol=2e-6)


TOP = {(0, 1): 2.5, (1, 3): 2.5, (2, 3): 2.5, (0, 2): 2.5}

SEMI: list[list[float]] = [
    [-0.9062501, -0.6565755, -0.6565755],
    [-0.9375001, -0.8593751, 0],
    [0.6095679, 2.793968e-09, -0.6095679],
    [-0.06327162, -0.6381173, 0.6381173],
    [-1, 2.793968e-09, 0],
    [0.7818288, 7.450581e-09, 0.3331405],
    [-0.5065587, 0.9118441, 0],
    [-0.05246913, 3.72529e-09, -0.8780864],
    [0.3089233, 0.3181223, 0.733511],
]
INFINITE_TOP: list[list[float]] = [
    [-1, -0.6666667, -0.6666667],
    [-1, -0.9166667, 0],
    [0.6095679, 2.793968e-09, -0.6095679],
    [-0.06327162, -0.6381173, 0.6381173],
    [-1, 2.793968e-09, 0],
    [0.7818288, 7.450581e-09, 0.3331405],
    [-0.5065587, 0.9118441, 0],
    [-0.05246913, 3.72529e-09, -0.8780864],
    [0.3089233, 0.3181223, 0.733511],
]
CORNERS: list[list[float]] = [
    [-0.5000001, -0.5000001, -0.5000001],
    [-0.6095679, -0.6095679, 1.862645e-09],
    [0.6095679, 2.793968e-09, -0.6095679],
    [-1.396984e-08, -0.6095679, 0.6095679],
    [-0.851852, 0.01234567, 0.01234567],
    [0.8173226, 0.03549381, 0.3686343],
    [-0.3670911, 0.8188658, 0.03703703],
    [1.303852e-08, 7.450581e-09, -0.8395063],
    [0.4204524, 0.4293258, 0.8421587],
]
BORDERED: list[list[float]] = [
    [0, 0, 0],
    [-0.2421875, 0.3802084, 0],
    [2.25, 0.7944445, 0.267963],
    [-0.0289352, 2.029977, 0.0950463],
    [0.0625, 3.291667, 0],
    [0.9856308, 0.5411124, 0.153139],
    [0.06245228, 1.493572, 0.09018109],
    [2.898377, 0.8845198, 0.3469906],
    [0.2526765, 3.222266, 0.09006174],
]


@pytest.mark.parametrize(
    ("polygons", "cage", "points"),
    [
        (cube(), Cage(sharpness=sharpness(TOP)), SEMI),
        (cube(), Cage(sharpness=sharpness(dict.fromkeys(TOP, INFINITE))), INFINITE_TOP),
        (cube(), Cage(sharpness=sharpness({}, {7: 2.5, 3: INFINITE})), CORNERS),
        (polygons_of(OPEN, OPEN_FACES), Cage(), BORDERED),
    ],
    ids=["semi-sharp", "sharp", "corners", "open"],
)
def test_creases_and_borders_are_those_of_opensubdiv(polygons: Polygons, cage: Cage, points: list[list[float]]) -> None:
    """Limit positions of OpenSubdiv as Blender 5.0.1 evaluates it, quality 6."""
    found = Refinement(cage, polygons, 2).refine().points
    for point in points:
        assert np.linalg.norm(found - point, axis=1).min() < 5e-6


def test_a_cube_with_sharp_edges_stays_a_cube() -> None:
    edges = {
        tuple(sorted(pair)): INFINITE for face in CUBE_FACES for pair in zip(face, face[1:] + face[:1], strict=True)
    }
    refined = Refinement(Cage(sharpness=sharpness(edges)), cube(), 3).refine()
    found = refined.points
    np.testing.assert_allclose(np.abs(found).max(axis=1), 1, atol=1e-6)
    assert np.abs(found).min(axis=1).min() < 0.1
    middles = found[refined.corners.reshape(-1, 4)].mean(axis=1)
    outward = np.where(np.abs(middles) > 1 - 1e-6, np.sign(middles), 0)
    np.testing.assert_allclose(corner_normals(refined), np.repeat(outward[:, None], 4, axis=1), atol=1e-6)


def corner_normals(polygons: Polygons) -> DoubleArray:
    """``(f, 4, 3)`` normals at the corners of quads."""
    assert polygons.normals is not None
    assert polygons.normals.indices is not None
    return polygons.normals.values[polygons.normals.indices].reshape(-1, 4, 3).astype(np.float64)


def ridge(n: int = 9) -> tuple[Polygons, list[int], float]:
    """A bicubic sheet z = y², lifted by 2x on one side of the middle; the points of the middle, and where it is."""
    flat, faces = grid(n)
    middle = (n - 1) / 2
    x, y = flat.T - middle
    heights = 2 * np.maximum(x, 0) + y**2
    return polygons_of(np.column_stack([x, y, heights]), faces), np.flatnonzero(x == 0).tolist(), middle


@pytest.mark.parametrize("left_handed", [False, True])
def test_normals_on_both_sides_of_a_crease(left_handed: bool) -> None:
    polygons, line, middle = ridge()
    crease = sharpness(dict.fromkeys(pairwise(line), INFINITE))
    levels = 4
    refined = Refinement(Cage(sharpness=crease), replace(polygons, left_handed=left_handed), levels).refine()
    corners = refined.points[refined.corners.reshape(-1, 4)].astype(np.float64)
    slope = np.where(corners.mean(axis=1)[:, 0] > 0, 2.0, 0.0)[:, None]
    inner = (np.abs(corners[..., :2]) < middle - 2).all(axis=(1, 2))  # of the border's creases
    y = corners[..., 1]
    wanted = np.stack([0 * y - slope, -2 * y, 1 + 0 * y], axis=-1) * (-1 if left_handed else 1)
    wanted /= np.linalg.norm(wanted, axis=-1, keepdims=True)
    np.testing.assert_allclose(corner_normals(refined)[inner], wanted[inner], atol=2e-3)
    at_crease = np.abs(corners[..., 0]) < 1e-6
    assert (at_crease & inner[:, None]).sum() > 100


def test_semi_sharp_creases_do_not_split_normals() -> None:
    polygons, line, _ = ridge()
    soft = Refinement(Cage(sharpness=sharpness(dict.fromkeys(pairwise(line), 9.0))), polygons, 2).refine()
    assert soft.normals is None


def test_a_crease_that_ends_is_smooth_at_its_end() -> None:
    polygons, line, _ = ridge()
    half = sharpness(dict.fromkeys(pairwise(line[: len(line) // 2 + 1]), INFINITE))
    refined = Refinement(Cage(sharpness=half), polygons, 2).refine()
    normals, corners = corner_normals(refined).reshape(-1, 3), refined.points[refined.corners]
    on_line = np.abs(corners[:, 0]) < 1e-6
    end = on_line & (np.abs(corners[:, 1]) < 1e-6)
    assert len(np.unique(np.round(normals[end], 5), axis=0)) == 1
    beside = on_line & (np.abs(corners[:, 1] + 1.5) < 0.01)
    assert len(np.unique(np.round(normals[beside], 5), axis=0)) == 2


def test_each_face_has_its_own_normal_at_a_sharp_corner() -> None:
    cone = Refinement(Cage(sharpness=sharpness({}, {0: INFINITE})), cube(), 2).refine()
    normals = corner_normals(cone).reshape(-1, 3)
    here = np.linalg.norm(cone.points[cone.corners] - CUBE[0], axis=1) < 1e-6
    assert len(np.unique(np.round(normals[here], 5), axis=0)) == 3
    elsewhere = np.unique(np.stack([cone.corners, cone.normals.indices], axis=1)[~here], axis=0)
    assert len(elsewhere) == len(np.unique(cone.corners)) - 1


@pytest.mark.parametrize(
    ("border", "faces", "corner"), [("edgeAndCorner", 9, 0.0), ("edgeOnly", 9, 1 / 6), ("none", 1, 1.0)]
)
def test_borders_follow_their_rule(border: str, faces: int, corner: float) -> None:
    """Sharp or round corners; without interpolation, faces at the border are not drawn."""
    flat, quads = grid(4)
    refined = Refinement(Cage(border=border), polygons_of(np.column_stack([flat, 0 * flat[:, 0]]), quads), 1).refine()
    holes = 0 if refined.holes is None else len(refined.holes)
    assert len(refined.counts) - holes == 4 * faces
    hidden = np.isin(np.arange(len(refined.counts)), [] if refined.holes is None else refined.holes)
    drawn = refined.points[refined.corners.reshape(-1, 4)[~hidden]].reshape(-1, 3)
    np.testing.assert_allclose(drawn[:, :2].min(axis=0), np.full(2, corner if border != "edgeOnly" else 0.0), atol=1e-6)
    np.testing.assert_allclose(drawn[:, :2].sum(axis=1).min(), 2 * corner, atol=1e-6)


def test_holes_stay_holes_and_faces_keep_their_numbers() -> None:
    refined = Refinement(Cage(), polygons_of(CUBE, CUBE_FACES, holes=[4, 9]), 2).refine()
    assert refined.holes is not None
    assert refined.authored is not None
    np.testing.assert_array_equal(refined.holes, np.flatnonzero(refined.authored.faces == 4))
    np.testing.assert_array_equal(np.bincount(refined.authored.faces), [16] * 6)


def test_primvars_follow_their_interpolation() -> None:
    refinement = Refinement(Cage(), cube(), 2)
    refined = refinement.refine()
    assert refined.authored is not None
    uniform = refinement.resample(Values(np.arange(6, dtype=np.float32)[:, None], "uniform"))
    assert uniform.indices is not None
    np.testing.assert_array_equal(uniform.values[uniform.indices, 0], refined.authored.faces)
    np.testing.assert_allclose(refinement.resample(Values(CUBE, "vertex")).values, refined.points, atol=1e-6)
    varying = refinement.resample(Values(CUBE, "varying")).values
    np.testing.assert_allclose(np.abs(varying).max(axis=1), 1, atol=1e-6)  # on the control mesh itself
    constant = Values(np.ones((1, 1), np.float32), "constant")
    assert refinement.resample(constant) is constant
    with pytest.raises(BadGeometry, match="needs"):
        refinement.resample(Values(CUBE[:5], "vertex"))


@pytest.mark.parametrize(
    ("rule", "corner"),
    [("all", 0), ("boundaries", 0), ("cornersPlus1", 0), ("cornersPlus2", 0), ("cornersOnly", 0), ("none", 1 / 6)],
)
def test_seams_of_texture_coordinates_follow_their_rule(rule: str, corner: float) -> None:
    """The four middle cells of a mesh are an island in texture space: its corners are round by ``none`` alone."""
    flat, faces = grid(5)
    points = np.column_stack([flat, 0 * flat[:, 0]])
    refinement = Refinement(Cage(face_varying=rule), polygons_of(points, faces), 3)
    index = np.concatenate(faces).reshape(-1, 4)
    is_island = (flat[index].mean(axis=1) > 1).all(axis=1) & (flat[index].mean(axis=1) < 3).all(axis=1)
    values = np.concatenate([flat - 10, flat]).astype(np.float32)
    found = refinement.resample(
        Values(values, "faceVarying", (index + 25 * is_island[:, None]).astype(np.int32).ravel())
    ).values
    island = found[found.min(axis=1) > 0]
    np.testing.assert_allclose([island.min(), island.max()], [1, 3], atol=1e-6)
    np.testing.assert_allclose(island.sum(axis=1).min(), 2 + 2 * corner, atol=1e-6)
    apart = refinement.resample(
        Values(np.tile([[0, 0], [1, 0], [1, 1], [0, 1]], (16, 1)).astype(np.float32), "faceVarying")
    )
    assert len(apart.values) == 16 * 81  # no cell shares a value with another


@pytest.mark.parametrize("scheme", ["catmullClark", "loop"])
def test_places_lead_from_refined_faces_to_fans_and_back(scheme: str) -> None:
    if scheme == "loop":
        polygons = polygons_of(OPEN, OPEN_TRIANGLES)
        cage = Cage("loop")
    else:
        polygons, cage = polygons_of(OPEN, OPEN_FACES), Cage(sharpness=sharpness({(1, 2): 1.5}))
    refined = Refinement(cage, polygons, 3).refine()
    assert refined.authored is not None
    limit = LimitPlaces(cage, polygons)
    faces = np.repeat(refined.authored.faces, refined.counts)
    for corner in np.random.default_rng(3).integers(0, len(refined.corners), 40).tolist():
        face, place = int(faces[corner]), refined.authored.places[corner].astype(np.float64)
        size = int(polygons.counts[face])
        (fan,), (weights,) = fans_of_places(place[None], size)
        np.testing.assert_allclose(place_in_fan(int(fan), weights, size), place, atol=1e-7)
        found = limit.weights(face, place)
        assert found is not None
        rows, shares = found
        np.testing.assert_allclose(shares.sum(), 1, atol=1e-9)
        np.testing.assert_allclose(shares @ polygons.points[rows], refined.points[refined.corners[corner]], atol=1e-5)


def test_what_contradicts_itself_is_named() -> None:
    with pytest.raises(BadGeometry, match="creaseIndices run from 0 to 9"):
        Refinement(Cage(sharpness=sharpness({(0, 9): 1.0})), cube(), 1)
    with pytest.raises(BadGeometry, match="loop, which takes triangles"):
        Refinement(Cage("loop"), cube(), 1)
    with pytest.raises(BadGeometry, match="not a number"):
        Refinement(Cage(sharpness=sharpness({(0, 1): np.nan})), cube(), 1)


def test_degenerate_faces_give_finite_points() -> None:
    """Two-cornered, repeated and non-manifold faces."""
    faces = [[0, 1], [0, 1, 2, 3], [0, 1, 2, 3], [3, 2, 1, 0], [4, 4, 4], [0, 5, 0, 6]]
    refined = Refinement(Cage(), polygons_of(np.random.default_rng(0).normal(size=(8, 3)), faces), 2).refine()
    check(refined)
    assert 0 not in np.unique(refined.authored.faces if refined.authored else [])


def test_a_face_with_very_many_neighbours_has_no_limit_places() -> None:
    """A cone of 300 triangles: its tip has more neighbours than places are looked for among; its base has, too."""
    count = 300
    turn = 2 * np.pi * np.arange(count) / count
    points = np.concatenate([[[0, 0, 1]], np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1)])
    sides = [[0, 1 + i, 1 + (i + 1) % count] for i in range(count)]
    cone = polygons_of(points, [*sides, list(range(count, 0, -1))])
    assert LimitPlaces(Cage(), cone).weights(count, np.zeros(2)) is None
    check(Refinement(Cage(), cone, 2).refine())
