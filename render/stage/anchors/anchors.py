"""World positions of focus points: a point sticks to its face as the face moves, deforms or is instanced, or to its place in
the bounds of a part."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.errors import InputError, NotFoundError, StageError
from render.model.arrays import DoubleArray
from render.stage.anchors.anchor_surfaces import AnchorSurface
from render.stage.anchors.displaced_places import DisplacedPlaces
from render.stage.anchors.part_bounds import Box, Boxes, PartBounds
from render.stage.assembly.inventory import InstancerLink
from render.stage.assembly.poses import InstanceReader, pose_of_instance, world_pose
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.skinning import Skeletons
from render.stage.opening import read_quietly
from render.stage.options import DEFAULT_OPTIONS, StageOptions
from render.stage.world import world_from_stage
from usd_schemas import FocusPoint


def anchor_position(stage: Usd.Stage, focus_point: FocusPoint, time: float) -> DoubleArray:
    """World position of a focus point at a time.

    It follows transforms, point animation, skeletons and blend shapes, native instances and point instancers.

    Args:
        stage: the stage.
        focus_point: its target is one path (a mesh, an implicit prim, or any xformable prim, whose origin is meant), or two (a
            point instancer and the prototype's mesh, whose number is ``instance``). One with a part follows the part's bounds
            instead.
        time: USD time code.

    Returns:
        ``(3,)`` float64 metres in the world, Y-up.

    Raises:
        NotFoundError: the target, its face or its instance does not exist at this time; or the part does not, or has no bounds.
        StageError: a transform is not finite.
    """
    return AnchorReader(stage).position(focus_point, time)


@dataclass(frozen=True, eq=False)
class Anchored:
    """Where focus points are over some times.

    Attributes:
        positions_m: ``(n, k, 3)`` float64 metres in the world, Y-up, of k points at n times; NaN where a point has no place.
        problems: for each time, why points have no place, by name.
    """

    positions_m: DoubleArray
    problems: tuple[dict[str, str], ...]


class AnchorReader:
    """Finds focus points on one stage; faster than :func:`anchor_position` for many times, since skeletons are kept.

    Args:
        stage: the stage.
        options: how the stage is drawn.
    """

    def __init__(self, stage: Usd.Stage, options: StageOptions = DEFAULT_OPTIONS) -> None:
        self._stage = stage
        self._options = options
        self._skeletons = Skeletons(stage)
        self._log = FindingLog()

    def position(self, focus_point: FocusPoint, time: float) -> DoubleArray:
        """As :func:`anchor_position`."""
        with read_quietly(self._stage):
            moment = _AnchorContext(_Sources(self._stage, self._skeletons, self._log, self._options), time)
            return moment.world(focus_point, moment.local(focus_point))

    def place_in_bounds(self, focus_point: FocusPoint, position_m: DoubleArray, time: float) -> DoubleArray:
        """Place in the bounds of a focus point's part at which it has a position.

        Args:
            focus_point: follows a part; its own place in the bounds does not matter, its offset does.
            position_m: ``(3,)`` metres in the world.
            time: USD time code.

        Returns:
            ``(3,)`` as ``boundsPoint``; 0.5 along an axis along which the bounds have no size.

        Raises:
            NotFoundError: the part or its instance does not exist at this time, or it has no bounds.
            StageError: a transform is not finite, or flattens space.
        """
        with read_quietly(self._stage):
            moment = _AnchorContext(_Sources(self._stage, self._skeletons, self._log, self._options), time)
            least, most = moment.bounds(focus_point)
            local = moment.local_of_world(focus_point, position_m)
        size = most - least
        has_size = size > _FLAT * size.max()
        along = local - np.array(focus_point.offset, np.float64) - least
        return np.where(has_size, along / np.where(has_size, size, 1.0), 0.5)

    def offset_to(self, focus_point: FocusPoint, position_m: DoubleArray, time: float) -> DoubleArray:
        """Offset of a focus point with which it has a position.

        Args:
            focus_point: as it is at the time; its own offset does not matter.
            position_m: ``(3,)`` metres in the world.
            time: USD time code.

        Returns:
            ``(3,)`` as ``offset``: in the space and units of what the point is attached to.

        Raises:
            NotFoundError: what it is attached to does not exist at this time, or has no bounds to follow.
            StageError: a transform is not finite, or flattens space; or the target's polygons cannot be used.
        """
        with read_quietly(self._stage):
            moment = _AnchorContext(_Sources(self._stage, self._skeletons, self._log, self._options), time)
            unmoved = moment.local(focus_point) - np.array(focus_point.offset, np.float64)
            return moment.local_of_world(focus_point, position_m) - unmoved

    def extent(self, focus_point: FocusPoint, time: float) -> tuple[DoubleArray, DoubleArray]:
        """Bounds in the world of what a focus point is attached to: its part, or else its target.

        Args:
            focus_point: as it is at the time.
            time: USD time code.

        Returns:
            ``(3,)`` their middle and ``(3, 3)`` columns from there to the middles of three of their sides, metres.

        Raises:
            NotFoundError: the part, the target or its instance does not exist at this time, or it has no bounds.
            StageError: a transform is not finite, or there are too many shapes.
        """
        with read_quietly(self._stage):
            moment = _AnchorContext(_Sources(self._stage, self._skeletons, self._log, self._options), time)
            least, most = moment.bounds(focus_point)
            middle = moment.world(focus_point, (least + most) / 2)
            tips = [moment.world(focus_point, (least + most) / 2 + step) for step in np.diag((most - least) / 2)]
        return middle, np.array(tips).T - middle[:, None]

    def positions(self, focus_points: Sequence[FocusPoint], times: Sequence[float]) -> DoubleArray:
        """Where focus points that say the same at all times are over some times.

        Args:
            focus_points: k points.
            times: n USD time codes.

        Returns:
            ``(n, k, 3)`` float64 metres in the world, Y-up; NaN for points without a position; `read_anchors` gives the reasons.
        """
        positions_m = self.read_anchors([focus_points] * len(times), times).positions_m
        return positions_m.reshape(len(times), len(focus_points), 3)

    def read_anchors(self, focus_points: Sequence[Sequence[FocusPoint]], times: Sequence[float]) -> Anchored:
        """World positions of focus points over some times; points without a position do not affect the others.

        Faces that do not change and transforms that do not move are read once for all times, and of a mesh's points only those
        that are asked for are bent.

        Args:
            focus_points: for each time the same number of points, as they are at that time.
            times: USD time codes.
        """
        sources = _Sources(self._stage, self._skeletons, self._log, self._options)
        rows = [
            self._at(_AnchorContext(sources, time), points) for points, time in zip(focus_points, times, strict=True)
        ]
        count = len(focus_points[0]) if focus_points else 0
        positions_m = np.array([positions for positions, _ in rows], np.float64).reshape(len(rows), count, 3)
        return Anchored(positions_m, tuple(problems for _, problems in rows))

    def _at(self, moment: _AnchorContext, points: Sequence[FocusPoint]) -> tuple[DoubleArray, dict[str, str]]:
        """``(k, 3)`` places at one time, and why some have none."""
        positions_m, problems = np.full((len(points), 3), np.nan), {}
        for number, point in enumerate(points):
            try:
                with read_quietly(self._stage):
                    position_m = moment.world(point, moment.local(point))
            except InputError as error:
                problems[point.name] = error.detail
                continue
            if np.isfinite(position_m).all():
                positions_m[number] = position_m
            else:
                problems[point.name] = f"focus point {point.name} has no finite place: {position_m}"
        return positions_m, problems


_FLAT = 1e-9
"""Bounds whose size along an axis is within this share of their largest have no size along it."""


class _Sources:
    """Sources shared by all times of one request."""

    def __init__(self, stage: Usd.Stage, skeletons: Skeletons, log: FindingLog, options: StageOptions) -> None:
        self.stage, self.skeletons, self.log = stage, skeletons, log
        self._options = options
        self.world = world_from_stage(stage)
        self.still_poses: dict[Hashable, DoubleArray] = {}
        self._surfaces: dict[str, AnchorSurface] = {}
        self._displaced = DisplacedPlaces(stage, skeletons, log, options.complexity)
        self._boxes = Boxes(skeletons, log)
        self._bounds: dict[str, PartBounds] = {}
        self._chains: dict[tuple[str, str], list[tuple[InstancerLink, ...]]] = {}

    def prim(self, focus_point: FocusPoint) -> Usd.Prim:
        """Prim that a focus point is attached to: its part, or else its target.

        Raises:
            NotFoundError: the target is not a prim with a place in the world, or the part does not exist.
        """
        if focus_point.part:
            return self._part(focus_point)
        path = focus_point.target[-1] if focus_point.target else ""
        prim = self.stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
        if not prim or not prim.IsActive() or not UsdGeom.Xformable(prim):
            why = "deactivated" if prim and not prim.IsActive() else "no prim with a place in the world"
            raise NotFoundError(
                f"focus point {focus_point.name} is on {path or 'nothing'}, which is {why}",
                code="anchor_not_found",
                path=path or None,
            )
        return prim

    def _part(self, focus_point: FocusPoint) -> Usd.Prim:
        path = focus_point.part
        prim = self.stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
        if prim and prim.IsActive():
            return prim
        why = "is deactivated" if prim else "is not there"
        raise NotFoundError(
            f"focus point {focus_point.name} follows the bounds of {path}, which {why}",
            code="anchor_not_found",
            path=path,
        )

    def bounds(self, prim: Usd.Prim) -> PartBounds:
        """The prim's bounds."""
        path = str(prim.GetPath())
        if path not in self._bounds:
            self._bounds[path] = PartBounds(prim, self._boxes)
        return self._bounds[path]

    def surface(self, prim: Usd.Prim) -> AnchorSurface:
        """The prim's surface."""
        path = str(prim.GetPath())
        if path not in self._surfaces:
            self._surfaces[path] = AnchorSurface(prim, self.skeletons, self.log, self._options, self._displaced)
        return self._surfaces[path]

    def chains(self, instancer: str, prim: Usd.Prim) -> list[tuple[InstancerLink, ...]]:
        """Chains from an instancer to a prim below its prototypes; empty where the prim is not an instancer."""
        key = (instancer, str(prim.GetPath()))
        if key not in self._chains:
            found = self.stage.GetPrimAtPath(instancer) if Sdf.Path.IsValidPathString(instancer) else None
            self._chains[key] = _chains(found, prim) if found and found.IsA(UsdGeom.PointInstancer) else []
        return self._chains[key]


class _AnchorContext:
    """Where focus points are at one time."""

    def __init__(self, sources: _Sources, time: float) -> None:
        self._sources = sources
        self._time = Usd.TimeCode(time)
        self._transforms = UsdGeom.XformCache(self._time)
        self._instances = InstanceReader(self._time, FindingLog())
        self._poses: dict[Hashable, DoubleArray] = {}
        self._bounds: dict[str, Box | None] = {}

    def local(self, focus_point: FocusPoint) -> DoubleArray:
        """``(3,)`` the place in the target's own space and units: on its triangle, or its origin where no face is named. Of a
        point with a part, the place in the part's bounds, in the part's own space.

        Raises:
            NotFoundError: the target or its triangle does not exist, or the part or its bounds.
            StageError: the target's polygons cannot be used.
        """
        if focus_point.part:
            least, most = self.bounds(focus_point)
            inside = least + np.array(focus_point.bounds_point, np.float64) * (most - least)
            return np.asarray(inside + np.array(focus_point.offset, np.float64))
        prim = self._sources.prim(focus_point)
        surface = self._sources.surface(prim)
        try:
            found = surface.find(focus_point, self._time)
            on_surface = np.zeros(3) if found is None else found
        except BadGeometry as problem:
            raise StageError(f"focus point {focus_point.name} is on {prim.GetPath()}, but {problem}") from problem
        return np.asarray(on_surface + np.array(focus_point.offset, np.float64))

    def bounds(self, focus_point: FocusPoint) -> Box:
        """Least and greatest corner of the bounds of a focus point's part, in the part's own space and units.

        Raises:
            NotFoundError: the part does not exist, or has no bounds.
        """
        prim = self._sources.prim(focus_point)
        path = str(prim.GetPath())
        if path not in self._bounds:
            self._bounds[path] = self._sources.bounds(prim).at(self._time, self._transforms)
        bounds = self._bounds[path]
        if bounds is None:
            raise NotFoundError(
                f"focus point {focus_point.name} follows the bounds of {path}, which has none at time "
                f"{self._time.GetValue():g}: there is nothing to be seen of it",
                code="anchor_not_found",
                path=path,
            )
        return bounds

    def local_of_world(self, focus_point: FocusPoint, position_m: DoubleArray) -> DoubleArray:
        """``(3,)`` a place in the world, in metres, brought to the space and units of what a focus point is attached to.

        Raises:
            NotFoundError: the instance does not exist.
            StageError: a transform is not finite, or flattens space.
        """
        pose = self._pose(focus_point)
        try:
            return np.asarray(np.linalg.solve(pose[:3, :3], position_m - pose[:3, 3]), np.float64)
        except np.linalg.LinAlgError as problem:
            path = self._sources.prim(focus_point).GetPath()
            follows = "follow the bounds of" if focus_point.part else "be moved on"
            detail = f"focus point {focus_point.name} cannot {follows} {path}, whose transform is flat"
            raise StageError(f"{detail} at time {self._time.GetValue():g}") from problem

    def world(self, focus_point: FocusPoint, local: DoubleArray) -> DoubleArray:
        """``(3,)`` metres: a place in the target's own space, brought to the world.

        Raises:
            NotFoundError: the instance does not exist.
            StageError: a transform is not finite.
        """
        pose = self._pose(focus_point)
        return np.asarray(pose[:3, :3] @ local + pose[:3, 3])

    def _pose(self, focus_point: FocusPoint) -> DoubleArray:
        key = (focus_point.target, focus_point.instance, focus_point.part)
        known = self._sources.still_poses.get(key, self._poses.get(key))
        if known is None:
            prim = self._sources.prim(focus_point)
            if self._is_instanced(focus_point, prim):
                known = self._poses[key] = self._instance_pose(focus_point, prim)
            else:
                known = world_pose(prim, self._transforms, self._sources.world)
                (self._poses if _moves(prim) else self._sources.still_poses)[key] = known
        return known

    def _is_instanced(self, focus_point: FocusPoint, prim: Usd.Prim) -> bool:
        """Whether a prim is an instancer's: as the target of two paths is, but only such parts as are below its prototypes."""
        if len(focus_point.target) < 2:
            return False
        return not focus_point.part or bool(self._sources.chains(focus_point.target[0], prim))

    def _check_chains(self, focus_point: FocusPoint, chains: Sequence[tuple[InstancerLink, ...]]) -> None:
        """Check that the number of a point's instance means the same for its part as for its target.

        Raises:
            StageError: the part is of an outer one of instancers in instancers, and the target of an inner one.
        """
        target = self._sources.stage.GetPrimAtPath(focus_point.target[1])
        wanted = {len(chain) for chain in self._sources.chains(focus_point.target[0], target)} if target else set()
        if wanted and not wanted & {len(chain) for chain in chains}:
            raise StageError(
                f"focus point {focus_point.name} cannot follow the bounds of {focus_point.part}, which holds the instancer "
                "that its target is an instance of: follow a part below that instancer's prototypes"
            )

    def _instance_pose(self, focus_point: FocusPoint, prim: Usd.Prim) -> DoubleArray:
        chains = self._sources.chains(focus_point.target[0], prim)
        if focus_point.part:
            self._check_chains(focus_point, chains)
        for chain in chains:
            pose = pose_of_instance(
                chain, focus_point.instance, prim, self._transforms, self._sources.world, self._instances
            )
            if pose is not None:
                return pose
        raise NotFoundError(
            f"focus point {focus_point.name} is on instance {focus_point.instance} of {focus_point.target[0]}, "
            f"which does not exist at time {self._time.GetValue():g}",
            code="anchor_not_found",
            path=focus_point.target[0],
        )


def _moves(prim: Usd.Prim) -> bool:
    """Whether a prim's place in the world may change over time."""
    while prim and not prim.IsPseudoRoot():
        xformable = UsdGeom.Xformable(prim)
        if xformable and xformable.TransformMightBeTimeVarying():
            return True
        prim = prim.GetParent()
    return False


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
