"""Where a focus point is in the world at a time: it sticks to its face, whatever moves, bends or multiplies that face."""

from __future__ import annotations

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.errors import NotFoundError, StageError
from render.stage.findings import FindingLog
from render.stage.inventory import InstancerLink
from render.stage.opening import reading
from render.stage.polygons import BadGeometry, Polygons, check
from render.stage.poses import pose_of_instance, world_pose
from render.stage.skinning import Skeletons
from render.stage.surface import is_drawable, surface_of
from render.stage.world import DoubleArray, world_from_stage
from usd_schemas import FocusPoint


def anchor_position(stage: Usd.Stage, focus_point: FocusPoint, time: float) -> DoubleArray:
    """Where a focus point is at a time.

    It follows transforms, point animation, skeletons and blend shapes, native instances and point instancers.

    Args:
        stage: the stage.
        focus_point: its target is one path (a mesh, an implicit prim, or any xformable prim, whose origin is meant), or two (a
            point instancer and the prototype's mesh, of which ``instance`` says the number).
        time: USD time code.

    Returns:
        ``(3,)`` float64 metres in the world, Y-up.

    Raises:
        NotFoundError: the target, its face or its instance does not exist at this time.
        StageError: a transform is not finite.
    """
    return AnchorReader(stage).position(focus_point, time)


class AnchorReader:
    """Finds focus points on one stage; faster than :func:`anchor_position` for many times, since skeletons are kept.

    Args:
        stage: the stage.
    """

    def __init__(self, stage: Usd.Stage) -> None:
        self._stage = stage
        self._skeletons = Skeletons(stage)
        self._log = FindingLog()

    def position(self, focus_point: FocusPoint, time: float) -> DoubleArray:
        """As :func:`anchor_position`."""
        with reading(self._stage):
            return self._position(focus_point, time)

    def _position(self, focus_point: FocusPoint, time: float) -> DoubleArray:
        prim = self._prim(focus_point)
        transforms = UsdGeom.XformCache(Usd.TimeCode(time))
        world = world_from_stage(self._stage)
        if len(focus_point.target) > 1:
            pose = self._instance_pose(focus_point, prim, transforms, world)
        else:
            pose = world_pose(prim, transforms, world)
        local = self._on_surface(focus_point, prim, transforms.GetTime()) + np.array(focus_point.offset, np.float64)
        position: DoubleArray = pose[:3, :3] @ local + pose[:3, 3]
        return position

    def _prim(self, focus_point: FocusPoint) -> Usd.Prim:
        path = focus_point.target[-1] if focus_point.target else ""
        prim = self._stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
        if not prim or not UsdGeom.Xformable(prim):
            what = path or "nothing"
            raise NotFoundError(
                f"focus point {focus_point.name} is on {what}, which is no prim with a place in the world",
                code="anchor_not_found",
                path=path or None,
            )
        return prim

    def _on_surface(self, focus_point: FocusPoint, prim: Usd.Prim, time: Usd.TimeCode) -> DoubleArray:
        """``(3,)`` the point in the prim's own space and units; its origin without a surface, or where no face is named."""
        if focus_point.face == -1 or not is_drawable(prim):
            return np.zeros(3)
        try:
            polygons = surface_of(prim, time, self._skeletons, self._log)
            check(polygons)
        except BadGeometry as problem:
            raise StageError(f"focus point {focus_point.name} is on {prim.GetPath()}, but {problem}") from problem
        corners = polygons.points[_triangle(polygons, focus_point)].astype(np.float64)
        position: DoubleArray = np.array(focus_point.barycentric, np.float64) @ corners
        return position

    def _instance_pose(
        self, focus_point: FocusPoint, prim: Usd.Prim, transforms: UsdGeom.XformCache, world: DoubleArray
    ) -> DoubleArray:
        instancer = self._stage.GetPrimAtPath(focus_point.target[0])
        for chain in _chains(instancer, prim) if instancer and instancer.IsA(UsdGeom.PointInstancer) else ():
            pose = pose_of_instance(chain, focus_point.instance, prim, transforms, world)
            if pose is not None:
                return pose
        raise NotFoundError(
            f"focus point {focus_point.name} is on instance {focus_point.instance} of {focus_point.target[0]}, "
            f"which does not exist at time {transforms.GetTime().GetValue():g}",
            code="anchor_not_found",
            path=focus_point.target[0],
        )


def _triangle(polygons: Polygons, focus_point: FocusPoint) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """``(3,)`` point indices of the triangle of the face's fan."""
    face, fan = focus_point.face, focus_point.fan_triangle
    if not 0 <= face < len(polygons.counts) or not 0 <= fan < polygons.counts[face] - 2:
        raise NotFoundError(
            f"focus point {focus_point.name} is on triangle {fan} of face {face}, which {focus_point.target[-1]} does not have",
            code="anchor_not_found",
            path=focus_point.target[-1],
        )
    first = int(polygons.counts[:face].sum(dtype=np.int64))
    return polygons.corners[[first, first + fan + 1, first + fan + 2]].astype(np.int64)


def _chains(
    instancer: Usd.Prim, prim: Usd.Prim, before: tuple[InstancerLink, ...] = ()
) -> list[tuple[InstancerLink, ...]]:
    """The ways from an instancer to a prim below its prototypes, through instancers nested in them."""
    found: list[tuple[InstancerLink, ...]] = []
    stage = instancer.GetStage()
    for number, target in enumerate(UsdGeom.PointInstancer(instancer).GetPrototypesRel().GetForwardedTargets()):
        root = stage.GetPrimAtPath(target)
        if not root or any(link.instancer == instancer for link in before):
            continue
        chain = (*before, InstancerLink(instancer, number, root))
        if prim.GetPath().HasPrefix(target):
            found.append(chain)
        for nested in Usd.PrimRange(root, Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)):
            if nested.IsA(UsdGeom.PointInstancer):
                found.extend(_chains(nested, prim, chain))
    return found
