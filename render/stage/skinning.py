"""UsdSkel: meshes bent by skeletons and blend shapes, computed by UsdSkel's own skinning queries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from pxr import Usd, UsdGeom, UsdSkel, Vt

from render.stage.findings import FindingLog
from render.stage.polygons import BadGeometry, FloatArray, Polygons, Values, carried_normals, check, fan
from render.stage.world import column_matrix


class Skeletons:
    """Which prims of a stage a skeleton bends, and how.

    Args:
        stage: the stage. It is searched for skeletons when first asked about a prim below a SkelRoot.
    """

    def __init__(self, stage: Usd.Stage) -> None:
        self._stage = stage
        self._cache = UsdSkel.Cache()
        self._bound: dict[str, tuple[UsdSkel.SkeletonQuery, UsdSkel.SkinningQuery]] = {}
        self._searched: set[str] = set()

    def bends(self, prim: Usd.Prim) -> bool:
        """Whether a skeleton or a blend shape moves this prim's points."""
        return self._query(prim) is not None

    def bend(self, prim: Usd.Prim, polygons: Polygons, time: Usd.TimeCode, log: FindingLog) -> Polygons:
        """The polygons as the skeleton has them at a time, in the prim's own space; unchanged where none is bound."""
        found = self._query(prim)
        if found is None:
            return polygons
        skeleton, skinning = found
        points = Vt.Vec3fArray.FromNumpy(polygons.points)
        if skinning.HasBlendShapes() and not _blend(skeleton, skinning, points, time):
            log.add(
                "blend_shapes_ignored", prim.GetPath(), f"the blend shapes of {prim.GetPath()} could not be computed"
            )
        if skinning.HasJointInfluences():
            joints = skeleton.ComputeSkinningTransforms(time)
            if not joints or not skinning.ComputeSkinnedPoints(joints, points, time):
                log.add(
                    "skinning_failed",
                    prim.GetPath(),
                    f"the skinning of {prim.GetPath()} could not be computed: drawn at rest",
                )
                return polygons
            moved = _in_prim_space(np.array(points, np.float32), skeleton.GetPrim(), prim, time)
        else:
            moved = np.array(points, np.float32)
        return replace(polygons, points=moved, normals=_bent_normals(prim, polygons, moved, log))

    def _query(self, prim: Usd.Prim) -> tuple[UsdSkel.SkeletonQuery, UsdSkel.SkinningQuery] | None:
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
                    self._bound[str(target.GetPrim().GetPath())] = (skeleton, target)


def _blend(
    skeleton: UsdSkel.SkeletonQuery, skinning: UsdSkel.SkinningQuery, points: Vt.Vec3fArray, time: Usd.TimeCode
) -> bool:
    """Add the blend shapes' offsets to the points, in place. Returns whether that could be done."""
    animation = skeleton.GetAnimQuery()
    mapper = skinning.GetBlendShapeMapper()
    if not animation or mapper is None:
        return True  # shapes without an animation rest at weight 0
    weights = mapper.Remap(animation.ComputeBlendShapeWeights(time))
    shapes = UsdSkel.BlendShapeQuery(UsdSkel.BindingAPI(skinning.GetPrim()))
    sub_weights, shape_indices, sub_indices = shapes.ComputeSubShapeWeights(weights)
    return bool(
        shapes.ComputeDeformedPoints(
            sub_weights,
            shape_indices,
            sub_indices,
            shapes.ComputeBlendShapePointIndices(),
            shapes.ComputeSubShapePointOffsets(),
            points,
        )
    )


def _in_prim_space(points: FloatArray, skeleton: Usd.Prim, prim: Usd.Prim, time: Usd.TimeCode) -> FloatArray:
    """Points from the skeleton's space to the prim's, so that the prim's transform puts them where the skeleton is."""
    transforms = UsdGeom.XformCache(time)
    world_from_skeleton = column_matrix(transforms.GetLocalToWorldTransform(skeleton))
    world_from_prim = column_matrix(transforms.GetLocalToWorldTransform(prim))
    matrix = np.linalg.solve(world_from_prim, world_from_skeleton)
    return np.array(points @ matrix[:3, :3].T + matrix[:3, 3], np.float32)


def _bent_normals(prim: Usd.Prim, polygons: Polygons, moved: FloatArray, log: FindingLog) -> Values | None:
    if polygons.normals is None:
        return None
    check(polygons)
    try:
        return carried_normals(polygons, fan(polygons), moved)
    except BadGeometry as problem:
        path = prim.GetPath()
        log.add("bad_normals", path, f"the normals of {path} are computed instead of read: {problem}")
        return None
