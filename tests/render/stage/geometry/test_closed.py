"""Which surfaces are closed, so that their back faces are seen from within alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pxr import Usd

from render.stage.findings import FindingLog
from render.stage.geometry.closed import find_closed
from render.stage.geometry.packs import pack_surfaces
from render.stage.geometry.polygons import Polygons
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.surface import read_surface
from tests.render.kits.stages import new_stage

POINTS = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
FACES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]], np.int32)


def box(faces: np.ndarray = FACES, points: np.ndarray = POINTS) -> Polygons:
    return Polygons(points, np.full(len(faces), 4, np.int32), faces.ravel().astype(np.int32))


def is_closed(polygons: Polygons, *, seams: bool = True) -> bool:
    return bool(find_closed(pack_surfaces([polygons]), np.array([seams]))[0])


def boxes(*parts: Polygons) -> Polygons:
    """Several as one mesh."""
    firsts = np.cumsum([0, *(len(part.points) for part in parts[:-1])])
    return Polygons(
        np.concatenate([part.points for part in parts]),
        np.concatenate([part.counts for part in parts]),
        np.concatenate([part.corners + first for part, first in zip(parts, firsts, strict=True)]).astype(np.int32),
    )


@pytest.mark.parametrize(
    ("kind", "closed"),
    [(kind, True) for kind in ("Sphere", "Cube", "Cylinder", "Cylinder_1", "Cone", "Capsule", "Capsule_1")]
    + [("Plane", False)],
)
def test_solids_are_closed_and_a_plane_is_not(kind: str, closed: bool) -> None:
    stage = new_stage()
    prim = stage.DefinePrim("/p", kind)
    polygons = read_surface(prim, Usd.TimeCode.Default(), Skeletons(stage), FindingLog())
    assert is_closed(polygons) == closed


def test_a_box_is_closed_while_each_edge_is_passed_both_ways() -> None:
    turned = FACES.copy()
    turned[2] = turned[2, ::-1]
    assert is_closed(box())
    assert not is_closed(box(FACES[:5]))
    assert not is_closed(box(turned))
    assert not is_closed(replace(box(), holes=np.array([3], np.int32)))


def test_a_solid_that_faces_inwards_is_not_closed() -> None:
    inwards = box(FACES[:, ::-1])
    assert not is_closed(inwards)
    assert is_closed(replace(inwards, left_handed=True))
    assert not is_closed(replace(box(), left_handed=True))


def test_each_part_of_a_mesh_must_face_outwards() -> None:
    large, small = box(points=10 * POINTS), box(points=POINTS + np.float32(20))
    assert is_closed(boxes(large, small))
    assert not is_closed(boxes(large, box(FACES[:, ::-1], POINTS + np.float32(20))))


def test_faces_with_points_of_their_own_close_where_the_points_meet() -> None:
    apart = box(np.arange(24).reshape(6, 4), POINTS[FACES.ravel()])
    assert is_closed(apart)
    moved = apart.points.copy()
    moved[5] += 0.01
    assert not is_closed(replace(apart, points=moved))


def test_a_seam_closes_where_rounding_parts_it() -> None:
    """A tube bent to a ring: its first and last columns differ by the rounding of sin and cos."""
    turns = np.linspace(0, 2 * np.pi, 41)
    u, v = (grid.ravel() for grid in np.meshgrid(turns, turns, indexing="ij"))
    points = np.stack([(3 + np.cos(v)) * np.cos(u), (3 + np.cos(v)) * np.sin(u), np.sin(v)], axis=1).astype(np.float32)
    corner = (np.arange(40)[:, None] * 41 + np.arange(40)).ravel()
    ring = box(np.stack([corner, corner + 41, corner + 42, corner + 1], axis=1), points)
    assert is_closed(ring)
    assert not is_closed(replace(ring, counts=ring.counts[:-1], corners=ring.corners[:-4]))


def test_seams_are_left_open_where_they_may_come_apart() -> None:
    apart = box(np.arange(24).reshape(6, 4), POINTS[FACES.ravel()])
    assert is_closed(apart)
    assert not is_closed(apart, seams=False)
    assert is_closed(box(), seams=False)


def test_a_flat_solid_of_two_sides_is_closed() -> None:
    """A card whose two sides lie in one plane: each is drawn from its own side alone."""
    assert is_closed(Polygons(POINTS[:4], np.array([4, 4], np.int32), np.array([0, 2, 3, 1, 1, 3, 2, 0], np.int32)))
