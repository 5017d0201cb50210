"""UsdSkel: meshes bent by skeletons and blend shapes, computed by UsdSkel's own skinning queries."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdSkel, Vt

from render.model.arrays import FloatArray, LongArray
from render.stage.findings import FindingLog
from render.stage.geometry.blend_shapes import active_shapes, shape_normals
from render.stage.geometry.polygons import BadGeometry, Polygons, Values, check, fan, transfer_normals
from render.stage.world import column_matrix


@dataclass(frozen=True, eq=False)
class _Bound:
    """Skinning of a prim.

    Attributes:
        prim: the skeleton beside the prim; a native instance's own, while the queries speak of the prototype's.
        skeleton: its joints.
        skinning: binding of the prim to the joints.
    """

    prim: Usd.Prim
    skeleton: UsdSkel.SkeletonQuery
    skinning: UsdSkel.SkinningQuery


class Skeletons:
    """Which prims of a stage a skeleton bends, and how.

    Args:
        stage: the stage. It is searched for skeletons at the first query of a prim below a SkelRoot.
    """

    def __init__(self, stage: Usd.Stage) -> None:
        self._stage = stage
        self._cache = UsdSkel.Cache()
        self._bound: dict[str, _Bound] = {}
        self._searched: set[str] = set()

    def bends(self, prim: Usd.Prim) -> bool:
        """Whether a skeleton or a blend shape moves this prim's points."""
        return self._query(prim) is not None

    def bend(self, prim: Usd.Prim, polygons: Polygons, time: Usd.TimeCode, log: FindingLog) -> Polygons:
        """The polygons as the skeleton has them at a time, in the prim's own space; unchanged where none is bound."""
        if not self.bends(prim):
            return polygons
        moved = self.bend_points(prim, Vt.Vec3fArray.FromNumpy(polygons.points), time, log)
        if polygons.normals is None:
            return replace(polygons, points=moved)
        return replace(polygons, points=moved, normals=self._bend_normals(prim, polygons, moved, time, log))

    def bend_points(
        self, prim: Usd.Prim, points: Vt.Vec3fArray, time: Usd.TimeCode, log: FindingLog, rows: LongArray | None = None
    ) -> FloatArray:
        """Points of a prim at a time, in its own space; its rest points without a usable skeleton.

        Args:
            prim: a mesh.
            points: all of its points, at rest.
            time: when.
            log: for findings.
            rows: indices of the points to compute, None for all.

        Returns:
            ``(n, 3)`` or ``(len(rows), 3)``.
        """
        found = self._query(prim)
        resting = points if rows is None else _pick_rows(points, rows)
        if found is None:
            return np.array(resting, np.float32)
        skeleton, skinning = found.skeleton, found.skinning
        shapes = active_shapes(skeleton, skinning, time)
        if shapes is not None:
            points = Vt.Vec3fArray(points)
            if not shapes.move(points):
                message = f"the blend shapes of {prim.GetPath()} could not be computed"
                log.add("blend_shapes_ignored", prim.GetPath(), message)
        selected = Vt.Vec3fArray(points) if rows is None else _pick_rows(points, rows)
        if not skinning.HasJointInfluences():
            return np.array(selected, np.float32)
        joints = skeleton.ComputeSkinningTransforms(time)
        if not joints or not _skin(found, joints, selected, rows, len(points), time):
            message = f"the skinning of {prim.GetPath()} could not be computed: drawn at rest"
            log.add("skinning_failed", prim.GetPath(), message)
            return np.array(resting, np.float32)
        return _in_prim_space(np.array(selected, np.float32), found.prim, prim, time)

    def _bend_normals(
        self, prim: Usd.Prim, polygons: Polygons, moved: FloatArray, time: Usd.TimeCode, log: FindingLog
    ) -> Values | None:
        """Authored normals, carried along from rest. Where blend shapes say how these change, they are carried from there on."""
        check(polygons)
        try:
            return transfer_normals(shaped := self._shape_normals(prim, polygons, time), fan(shaped), moved)
        except BadGeometry as problem:
            path = prim.GetPath()
            log.add("bad_normals", path, f"the normals of {path} are computed instead of read: {problem}")
            return None

    def _shape_normals(self, prim: Usd.Prim, polygons: Polygons, time: Usd.TimeCode) -> Polygons:
        found = self._query(prim)
        shapes = None if found is None else active_shapes(found.skeleton, found.skinning, time)
        offsets = None if shapes is None else shapes.normal_offsets(len(polygons.points))
        if shapes is None or offsets is None:
            return polygons
        points = Vt.Vec3fArray.FromNumpy(polygons.points)
        shapes.move(points)
        return replace(shape_normals(polygons, offsets), points=np.array(points, np.float32))

    def _query(self, prim: Usd.Prim) -> _Bound | None:
        root = UsdSkel.Root.Find(prim)
        if not root:
            return None
        path = str(root.GetPath())
        if path not in self._searched:
            self._searched.add(path)
            self._search(root)
        return self._bound.get(str(prim.GetPath()))

    def _search(self, root: UsdSkel.Root) -> None:
        predicate = Usd.TraverseInstanceProxies()
        self._cache.Populate(root, predicate)
        for binding in self._cache.ComputeSkelBindings(root, predicate):
            skeleton = self._cache.GetSkelQuery(binding.GetSkeleton())
            for target in binding.GetSkinningTargets():
                if skeleton and (target.HasJointInfluences() or target.HasBlendShapes()):
                    bound = _Bound(binding.GetSkeleton().GetPrim(), skeleton, target)
                    self._bound[str(target.GetPrim().GetPath())] = bound


def _skin(
    bound: _Bound,
    joints: Vt.Matrix4dArray,
    points: Vt.Vec3fArray,
    rows: LongArray | None,
    count: int,
    time: Usd.TimeCode,
) -> bool:
    """Move points with their joints, in place: all ``count`` of a mesh, or those of its ``rows``. Returns whether that worked."""
    skinning = bound.skinning
    if rows is None:
        return bool(skinning.ComputeSkinnedPoints(joints, points, time))
    influences = skinning.ComputeVaryingJointInfluences(count, time)
    if not influences:
        return False
    each = skinning.GetNumInfluencesPerComponent()
    of_rows = (rows[:, None] * each + np.arange(each)).ravel()
    indices, weights = (np.asarray(values)[of_rows] for values in influences)
    return bool(
        UsdSkel.SkinPoints(
            skinning.GetSkinningMethod(),
            skinning.GetGeomBindTransform(time),
            _in_order(joints, bound.skeleton.GetJointOrder(), skinning.GetJointOrder()),
            Vt.IntArray.FromNumpy(indices),
            Vt.FloatArray.FromNumpy(weights),
            each,
            points,
        )
    )


def _in_order(joints: Vt.Matrix4dArray, given: Vt.TokenArray, selected: Vt.TokenArray | None) -> Vt.Matrix4dArray:
    """Joints in a mesh's own order, as USD's mapper has them (in Python it gives nothing back): those that lack stand still."""
    if selected is None:
        return joints
    place = {name: number for number, name in enumerate(given)}
    return Vt.Matrix4dArray([joints[place[name]] if name in place else Gf.Matrix4d(1) for name in selected])


def _pick_rows(points: Vt.Vec3fArray, rows: LongArray) -> Vt.Vec3fArray:
    return Vt.Vec3fArray([points[row] for row in rows.tolist()])


def _in_prim_space(points: FloatArray, skeleton: Usd.Prim, prim: Usd.Prim, time: Usd.TimeCode) -> FloatArray:
    """Transform points from the skeleton's space to the prim's."""
    transforms = UsdGeom.XformCache(time)
    world_from_skeleton = column_matrix(transforms.GetLocalToWorldTransform(skeleton))
    world_from_prim = column_matrix(transforms.GetLocalToWorldTransform(prim))
    matrix = np.linalg.solve(world_from_prim, world_from_skeleton)
    return np.array(points @ matrix[:3, :3].T + matrix[:3, 3], np.float32)
