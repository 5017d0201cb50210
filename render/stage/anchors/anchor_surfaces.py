"""Surfaces that focus points are anchored to; of large ones only the needed points are read."""

from __future__ import annotations

import numpy as np
from pxr import Usd, UsdGeom, Vt

from render.errors import NotFoundError
from render.model.arrays import DoubleArray, IntArray, LongArray
from render.model.face_places import place_in_fan
from render.stage.anchors.displaced_places import DisplacedPlaces
from render.stage.assembly.draw_modes import mode_of
from render.stage.findings import FindingLog
from render.stage.geometry.generated import generated_varies, is_generated
from render.stage.geometry.points_data import has_velocities
from render.stage.geometry.polygons import BadGeometry, Polygons
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.splat_boxes import splat_place, splats_move
from render.stage.geometry.stand_ins import stand_in_polygons
from render.stage.geometry.subdivision.limit_places import LimitPlaces
from render.stage.geometry.subdivision.reading import is_refined
from render.stage.geometry.surface import (
    faces_vary,
    is_drawable,
    limit_places,
    mesh_faces,
    mesh_points,
    read_surface,
    resting_points,
)
from render.stage.materials.stand_in_looks import read_stand_in
from render.stage.materials.textures import TextureCache
from render.stage.opening import confinement
from render.stage.options import StageOptions
from render.stage.values import SPLATS, schema_type
from usd_schemas import FocusPoint


class AnchorSurface:
    """Surface of one prim. Faces and points that do not vary over time are read once.

    Args:
        prim: any prim with a place.
        skeletons: bend meshes.
        log: for findings.
        options: how the stage is drawn: points on refined meshes are on the limit surface, those on models with a draw mode on
            their stand-ins.
        displaced: finds places on displaced surfaces.
    """

    def __init__(
        self,
        prim: Usd.Prim,
        skeletons: Skeletons,
        log: FindingLog,
        options: StageOptions,
        displaced: DisplacedPlaces,
    ) -> None:
        self._prim, self._skeletons, self._log, self._displaced = prim, skeletons, log, displaced
        self._mode = mode_of(prim) if options.draw_modes else ""
        self._is_cloud = not self._mode and schema_type(prim) == SPLATS
        self._splats: dict[int, DoubleArray] = {}  # those that stand still
        self._splats_move = self._is_cloud and splats_move(prim)
        self._is_generated = bool(self._mode) or is_generated(prim)
        self._reshapes = bool(self._mode) or (generated_varies(prim) if self._is_generated else faces_vary(prim))
        self._is_refined = not self._mode and is_refined(prim, options.complexity)
        self._faces: tuple[IntArray, IntArray, LongArray] | None = None
        self._limit: LimitPlaces | None = None
        self._points: DoubleArray | None = None  # of a prim that is no mesh
        self._resting: tuple[Usd.TimeCode, Vt.Vec3fArray] | None = None
        points = UsdGeom.Mesh(prim).GetPointsAttr() if prim.IsA(UsdGeom.Mesh) else None
        self._moves = points is not None and (points.ValueMightBeTimeVarying() or has_velocities(prim))

    def find(self, point: FocusPoint, time: Usd.TimeCode) -> DoubleArray | None:
        """``(3,)`` the place of a focus point in the prim's own space and units; None where it is on no face. Of splats, a
        face is one of them.

        Raises:
            NotFoundError: there is no such triangle or splat.
            BadGeometry: the faces contradict themselves, or the points are not there, or not finite.
        """
        if self._is_cloud:
            return None if point.face == -1 else self._splat(point, time)
        place = self._place(point, time)
        if place is None:
            return None
        if not self._mode:
            weights = np.array(point.barycentric, np.float64)
            displaced = self._displaced.find(self._prim, point.face, point.fan_triangle, weights, time)
            if displaced is not None:
                return displaced
        return np.asarray(place[1] @ self._points_at(place[0], time))

    def _place(self, point: FocusPoint, time: Usd.TimeCode) -> tuple[LongArray, DoubleArray] | None:
        """Point indices and their weights, ``(n,)`` each, that give the place of a focus point; None where it is on no face."""
        if point.face == -1 or not (self._mode or is_drawable(self._prim)):
            return None
        if self._faces is None or self._reshapes:
            self._faces = self._faces_at(time)
            self._limit = self._limit_at(time)
        counts, corners, starts = self._faces
        face, fan = point.face, point.fan_triangle
        if not 0 <= face < len(counts) or not 0 <= fan < counts[face] - 2:
            raise NotFoundError(
                f"focus point {point.name} is on triangle {fan} of face {face}, which {point.target[-1]} does not have",
                code="anchor_not_found",
                path=point.target[-1],
            )
        weights = np.array(point.barycentric, np.float64)
        if self._limit is not None:
            found = self._limit.weights(face, place_in_fan(fan, weights, int(counts[face])))
            if found is not None:
                return found
        return np.asarray(corners[starts[face] + np.array([0, fan + 1, fan + 2])], np.int64), weights

    def _splat(self, point: FocusPoint, time: Usd.TimeCode) -> DoubleArray:
        """``(3,)`` the middle of the splat that a point's face names."""
        place = self._splats.get(point.face)
        if place is None:
            place = splat_place(self._prim, point.face, time)
        if place is None:
            raise NotFoundError(
                f"focus point {point.name} is on splat {point.face}, which {point.target[-1]} does not have",
                code="anchor_not_found",
                path=point.target[-1],
            )
        if not self._splats_move:
            self._splats[point.face] = place
        return place

    def _points_at(self, rows: LongArray, time: Usd.TimeCode) -> DoubleArray:
        """``(n, 3)`` where some of the surface's points are, of those that `_place` gave for this time."""
        if self._points is not None:
            return self._points[rows]
        if self._resting is None or (self._moves and self._resting[0] != time):
            self._resting = (time, resting_points(self._prim, time))
        found = mesh_points(self._prim, self._resting[1], rows, time, self._skeletons, self._log)
        return found.astype(np.float64)

    def _faces_at(self, time: Usd.TimeCode) -> tuple[IntArray, IntArray, LongArray]:
        if self._is_generated:
            polygons = self._polygons(time)
            counts, corners = polygons.counts, polygons.corners
            self._points = polygons.points.astype(np.float64)
        else:
            counts, corners = mesh_faces(self._prim, time)
        sizes = counts.astype(np.int64)
        return counts, corners, np.cumsum(sizes) - sizes

    def _polygons(self, time: Usd.TimeCode) -> Polygons:
        if not self._mode:
            return read_surface(self._prim, time, self._skeletons, self._log)
        textures = TextureCache(1, confined_to=confinement(self._prim.GetStage()))
        return stand_in_polygons(read_stand_in(self._prim, self._mode, textures, self._log), self._prim, time)

    def _limit_at(self, time: Usd.TimeCode) -> LimitPlaces | None:
        """Limit surface of a mesh that is refined; None where the mesh is drawn by its own faces."""
        if not self._is_refined:
            return None
        try:
            return limit_places(self._prim, time)
        except BadGeometry:
            return None  # it is drawn as its control mesh, with a finding
