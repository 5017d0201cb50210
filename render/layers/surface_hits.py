"""Surfaces that rays from a view's eye meet, and what is known of each: its ids, its normal and its place in its face."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from render.layers.index import Draw
from render.model.arrays import DoubleArray, IndexArray, IntArray, LongArray
from render.model.surface_points import SurfacePoints

_AT_ONCE = 1 << 16
"""Hits whose corners are held at once."""


@dataclass(frozen=True, eq=False)
class SurfaceHits:
    """Nearest surfaces along rays.

    Attributes:
        w: ``(height, width)`` float64 inverse depth, 1/m; 0 where nothing is.
        draws: ``(height, width)`` int32 index in `SceneIndex.draws`; -1 where nothing is.
        objects: ``(height, width)`` int64 object number (`Draw.first_object`).
        triangles: ``(height, width)`` int32 index in the draw's geometry.
        slopes: ``(height, width, 2)`` float64 of the ray, right and up, per unit of depth.
        splat_prims: ``(height, width)`` int32 index in `Scene.prim_paths` of splats that are met, of which nothing else is known;
            -1 elsewhere. None where the scene has none.
    """

    w: DoubleArray
    draws: IntArray
    objects: LongArray
    triangles: IntArray
    slopes: DoubleArray
    splat_prims: IntArray | None = None

    def at(self, rows: IndexArray, columns: IndexArray) -> SurfaceHits:
        """Hits of other pixels: of ``(rows, columns)`` at each."""
        place = rows, columns
        return SurfaceHits(
            self.w[place],
            self.draws[place],
            self.objects[place],
            self.triangles[place],
            self.slopes[place],
            None if self.splat_prims is None else self.splat_prims[place],
        )

    def behind_splats(self, w: DoubleArray, prims: IntArray) -> SurfaceHits:
        """Hits of splats where they are nearer.

        Args:
            w: ``(height, width)`` inverse depth of splats, 1/m; 0 where there are none.
            prims: ``(height, width)`` index of their prim; -1 of a holdout, which is nothing.
        """
        nearer = w > self.w
        return replace(
            self,
            w=np.where(nearer, np.where(prims < 0, 0.0, w), self.w),
            draws=np.where(nearer, np.int32(-1), self.draws),
            splat_prims=np.where(nearer, prims, np.int32(-1)),
        )


def without_holdouts(hits: SurfaceHits, draws: Sequence[Draw]) -> SurfaceHits:
    """Hits with nothing where they meet a holdout."""
    held = np.array([*(draw.batch.camera_role == "holdout" for draw in draws), False])[hits.draws]
    if not held.any():
        return hits
    return replace(hits, w=np.where(held, np.float32(0), hits.w), draws=np.where(held, np.int32(-1), hits.draws))


class SurfaceDescription:
    """Description of hits: each array is computed when it is first read.

    Args:
        draws: draws that the hits index.
        hits: the hits.
        camera_from_world: ``(4, 4)`` float64.
    """

    def __init__(self, draws: Sequence[Draw], hits: SurfaceHits, camera_from_world: DoubleArray) -> None:
        self._draws, self._hits, self._camera_from_world = draws, hits, camera_from_world

    @property
    def prim_ids(self) -> IntArray:
        """``(height, width)`` int32 index in `Scene.prim_paths` of the prim that a hit is picked as; -1 where nothing is."""
        return self._ids[0]

    @property
    def face_ids(self) -> IntArray:
        """``(height, width)`` int32 index of the authored face; -1 where nothing is."""
        return self._ids[1]

    @property
    def instance_ids(self) -> IntArray:
        """``(height, width)`` int32 `Batch.instance_numbers`; -1 where there is no instance."""
        return self._ids[2]

    @property
    def points(self) -> SurfacePoints:
        """Hits as places on the faces of the stage's prims."""
        shape = self._hits.w.shape
        mesh_ids, fan_ids = (np.full(shape, -1, np.int32) for _ in range(2))
        weights = self._weights_and_normals[0].copy()
        for draw, here in self._by_draw():
            batch, triangles = draw.batch, self._hits.triangles[here]
            geometry = batch.geometry
            fan_ids[here], weights[here] = geometry.fan_points(triangles, weights[here])
            own_ids = (
                batch.instance_prim_ids if batch.instance_numbers is None else None
            )  # native instances are prims themselves
            mesh_ids[here] = geometry.prim_ids[triangles] if own_ids is None else own_ids[self._poses(draw, here)]
        return SurfacePoints(mesh_ids, self.face_ids, fan_ids, weights)

    @property
    def normals(self) -> DoubleArray:
        """``(height, width, 3)`` float64 unit normals in camera space, those of the vertices interpolated, on the side of the
        triangle that is seen; 0 where nothing is."""
        return self._weights_and_normals[1]

    @cached_property
    def _ids(self) -> tuple[IntArray, IntArray, IntArray]:
        prims, faces, instances = (np.full(self._hits.w.shape, -1, np.int32) for _ in range(3))
        for draw, here in self._by_draw():
            batch, triangles = draw.batch, self._hits.triangles[here]
            poses = self._poses(draw, here)
            own = batch.instance_prim_ids
            prims[here] = batch.geometry.prim_ids[triangles] if own is None else own[poses]
            faces[here] = batch.geometry.face_ids[triangles]
            if batch.instance_numbers is not None:
                instances[here] = batch.instance_numbers[poses]
        splats = self._hits.splat_prims
        if splats is not None:
            prims = np.where(splats >= 0, splats, prims)
        return prims, faces, instances

    @cached_property
    def _weights_and_normals(self) -> tuple[DoubleArray, DoubleArray]:
        """Weights of the triangle's corners at each hit, and the normal there."""
        weights, normals = (np.zeros((*self._hits.w.shape, 3)) for _ in range(2))
        for draw, every in self._by_draw():
            for first in range(0, len(every[0]), _AT_ONCE):
                here = tuple(some[first : first + _AT_ONCE] for some in every)
                weights[here], normals[here] = self._describe(draw, here)
        return weights, normals

    def _describe(self, draw: Draw, here: tuple[IndexArray, ...]) -> tuple[DoubleArray, DoubleArray]:
        """Weights and normals ``(n, 3)`` of hits of one draw."""
        geometry = draw.batch.geometry
        corners = geometry.triangles[self._hits.triangles[here]]
        used, which = np.unique(self._poses(draw, here), return_inverse=True)
        poses = (self._camera_from_world @ draw.batch.poses[used])[which]
        places = geometry.positions[corners].astype(np.float64)
        places = places @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
        edges = places[:, 1] - places[:, 0], places[:, 2] - places[:, 0]
        across = np.cross(*edges)
        direction = np.concatenate([self._hits.slopes[here], np.full((len(corners), 1), -1.0)], axis=1)
        weights = _meet(places[:, 0], *edges, direction)
        smooth = np.einsum("nc,nck->nk", weights, geometry.normals[corners].astype(np.float64))
        normals = np.einsum("nij,nj->ni", _cofactors(poses[:, :3, :3]), smooth)
        # the cofactors of a mirror turn a normal about, and so does its winding
        normals *= np.sign(np.linalg.det(poses[:, :3, :3]))[:, None]
        across *= -1.0 if draw.mirrored else 1.0
        seen_from_behind = np.sum(across * direction, axis=1) > 0
        flat = np.sum(normals * normals, axis=1) <= 1e-20
        normals[flat] = across[flat]
        normals[seen_from_behind] *= -1
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        return weights, normals / np.where(length > 0, length, 1.0)

    def _poses(self, draw: Draw, here: tuple[IndexArray, ...]) -> IndexArray:
        """Indices of the poses of a draw's batch."""
        poses: IndexArray = draw.instances[self._hits.objects[here] - draw.first_object]
        return poses

    def _by_draw(self) -> Iterator[tuple[Draw, tuple[IndexArray, ...]]]:
        """Each draw that is hit, with the pixels that hit it."""
        draws = self._hits.draws
        order = np.argsort(draws, axis=None, kind="stable")
        numbers, firsts = np.unique(draws.ravel()[order], return_index=True)
        for number, some in zip(numbers, np.split(order, firsts[1:]), strict=True):
            if number >= 0:
                yield self._draws[number], np.unravel_index(some, draws.shape)


def _meet(corner: DoubleArray, e1: DoubleArray, e2: DoubleArray, direction: DoubleArray) -> DoubleArray:
    """Weights ``(n, 3)`` of the corners where rays from the origin meet triangles' planes, clamped to the triangles (Moeller &
    Trumbore 1997, "Fast, Minimum Storage Ray-Triangle Intersection")."""
    p = np.cross(direction, e2)
    determinant = np.sum(e1 * p, axis=1)
    edge_on = np.abs(determinant) < 1e-300
    determinant = np.where(edge_on, 1.0, determinant)
    u = np.sum(-corner * p, axis=1) / determinant
    v = np.sum(direction * np.cross(-corner, e1), axis=1) / determinant
    weights = np.clip(np.stack([1 - u - v, u, v], axis=1), 0.0, 1.0)
    weights[edge_on] = 1.0
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def _cofactors(matrices: DoubleArray) -> DoubleArray:
    """Cofactors of ``(n, 3, 3)`` matrices: their inverse transposes times their determinants."""
    a, b, c = matrices[:, 0], matrices[:, 1], matrices[:, 2]
    return np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
