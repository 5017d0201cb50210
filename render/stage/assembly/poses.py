"""Where things stand: transforms of prims and of point instances, as arrays for column vectors."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from pxr import Gf, Tf, Usd, UsdGeom, Vt

from render.model.arrays import DoubleArray, IntArray
from render.stage.assembly.inventory import InstancerLink
from render.stage.findings import FindingLog
from render.stage.limits import PlaceError, check_places
from render.stage.values import UNREADABLE, format_value, why_unreadable
from render.stage.world import column_matrix

Matrix = TypeVar("Matrix")


def world_pose(prim: Usd.Prim, transforms: UsdGeom.XformCache, world: DoubleArray) -> DoubleArray:
    """Pose ``(4, 4)`` of a prim: world (metres, Y-up) from its own space in stage units.

    Raises:
        PlaceError: the transform is not finite; names the prim.
    """
    matrix = column_matrix(_computed(lambda: transforms.GetLocalToWorldTransform(prim)))
    if not np.isfinite(matrix).all():
        raise _not_finite(_culprit(prim, transforms))
    return np.asarray(world @ matrix)


def _computed(compute: Callable[[], Matrix]) -> Matrix:
    """Transform that USD computes and caches. Transform operations that it cannot read count as none, as in usdrecord; the
    inventory names them. USD raises an error for each of them once, and then has the result in its cache."""
    try:
        return compute()
    except Tf.ErrorException:
        return compute()


_LISTS = (
    "protoIndices",
    "positions",
    "orientations",
    "orientationsf",
    "scales",
    "velocities",
    "accelerations",
    "angularVelocities",
)
"""All attributes of a PointInstancer with one value for each instance, except ``ids``."""


@dataclass(frozen=True, eq=False)
class _Instances:
    """All instances of a point instancer.

    Attributes:
        matrices: ``(n, 4, 4)`` instancer from prototype root.
        prototypes: ``(n,)`` which prototype each is of.
        visible: ``(n,)`` bool.
        names: ``(n,)`` ids that identify them over time, else their indices.
    """

    matrices: DoubleArray
    prototypes: IntArray
    visible: NDArray[np.bool_]
    names: IntArray


class InstanceReader:
    """Reads the instances of point instancers at one time, each instancer once.

    Args:
        time: when.
        log: notes instancers and instances that cannot be used.
    """

    def __init__(self, time: Usd.TimeCode, log: FindingLog) -> None:
        self._time, self._log = time, log
        self._transforms = UsdGeom.XformCache(time)
        self._read: dict[str, _Instances] = {}

    def prototype_instances(self, link: InstancerLink, *, drawn: bool = True) -> tuple[DoubleArray, IntArray, int]:
        """The instances of one prototype.

        Args:
            link: the instancer and which of its prototypes.
            drawn: whether those alone are meant that are visible.

        Returns:
            ``(k, 4, 4)`` instancer from prototype root, ``(k,)`` their indices, and how many instances of all prototypes
            there are; instances whose transforms are not finite are left out, with a finding.
        """
        every = self._of(link.instancer)
        indices = np.flatnonzero((every.visible | (not drawn)) & (every.prototypes == link.prototype)).astype(np.int32)
        local, _resets = _computed(lambda: self._transforms.GetLocalTransformation(link.root))
        with np.errstate(invalid="ignore", over="ignore"):
            matrices = every.matrices[indices] @ column_matrix(local)
        finite = np.flatnonzero(np.isfinite(matrices).all(axis=(1, 2)))
        if len(finite) < len(matrices):
            path = link.instancer.GetPath()
            count = f"{len(matrices) - len(finite):,} of {len(matrices):,} instances"
            message = f"{count} of {link.root.GetPath()} by {path} are not drawn: their transforms are not finite"
            self._log.add("bad_transform", path, message)
        return matrices[finite], indices[finite], len(every.prototypes)

    def names(self, instancer: Usd.Prim) -> IntArray:
        """Ids ``(n,)`` that identify an instancer's instances over time, or their indices where it has none."""
        return self._of(instancer).names

    def _of(self, instancer: Usd.Prim) -> _Instances:
        path = str(instancer.GetPath())
        if path not in self._read:
            self._read[path] = self._usable(UsdGeom.PointInstancer(instancer))
        return self._read[path]

    def _usable(self, instancer: UsdGeom.PointInstancer) -> _Instances:
        """Instances of an instancer; none, with a finding, where its values cannot be read."""
        path = instancer.GetPath()
        try:
            return self._instances(instancer)
        except UNREADABLE as problem:
            self._log.add("bad_instances", path, f"instancer {path} is not drawn: {why_unreadable(problem)}")
            none = np.zeros(0, np.int32)
            return _Instances(np.zeros((0, 4, 4)), none, np.zeros(0, bool), none)

    def _instances(self, instancer: UsdGeom.PointInstancer) -> _Instances:
        authored = instancer.GetProtoIndicesAttr().Get(self._time)
        if not isinstance(authored, Vt.IntArray | None):
            raise TypeError(f"protoIndices must be a list of whole numbers, got {format_value(authored)}")
        places = instancer.GetPositionsAttr().Get(self._time)
        if not isinstance(places, Vt.Vec3fArray | None):
            raise TypeError(f"positions must be a list of points, got {format_value(places)}")
        prototypes, positions = np.array(authored or [], np.int32), len(places or [])
        if len(prototypes) == positions:
            rows = _transforms(instancer, self._time)
        else:  # USD gives no transforms at all then
            scratch = Usd.Stage.CreateInMemory()
            rows = _transforms(_cut(instancer, min(len(prototypes), positions), self._time, scratch), self._time)
        matrices = np.array(rows, np.float64).reshape(-1, 4, 4).transpose(0, 2, 1)
        count = min(len(prototypes), len(matrices))
        self._note_faults(instancer, prototypes, positions, count)
        visible = np.ones(count, bool)
        mask = np.array(instancer.ComputeMaskAtTime(self._time) or [], bool)[:count]  # as many as there are ids
        visible[: len(mask)] = mask
        return _Instances(matrices[:count], prototypes[:count], visible, self._names(instancer, count))

    def _names(self, instancer: UsdGeom.PointInstancer, count: int) -> IntArray:
        authored = np.array(instancer.GetIdsAttr().Get(self._time) or [], np.int64)
        if not len(authored):
            return np.arange(count, dtype=np.int32)
        fit = authored[:count]
        if len(fit) < count or len(np.unique(fit)) < count or fit.min() < 0 or fit.max() > np.iinfo(np.int32).max:
            path = instancer.GetPath()
            fault = f"the instances of {path} are told apart by their indices: its ids must be"
            self._log.add("bad_ids", path, f"{fault} {count} different whole numbers from 0 to 2147483647")
            return np.arange(count, dtype=np.int32)
        return fit.astype(np.int32)

    def _note_faults(self, instancer: UsdGeom.PointInstancer, prototypes: IntArray, positions: int, count: int) -> None:
        path = instancer.GetPath()
        if len(prototypes) != positions or (positions and not count):
            drawn = "the instances that have both are drawn" if count else "it is not drawn"
            message = f"instancer {path} has {len(prototypes)} protoIndices and {positions} positions: {drawn}"
            self._log.add("bad_instances", path, message)
        if not count:
            return
        is_cut, prototypes = len(prototypes) != positions, prototypes[:count]
        for name in ("orientations", "orientationsf", "scales"):
            values = instancer.GetPrim().GetAttribute(name).Get(self._time)
            if values and (len(values) < count if is_cut else len(values) != count):
                message = f"the {name} of {path} are not used: there are {len(values)} for {count} instances"
                self._log.add(f"bad_{name}", path, message)
        targets = len(instancer.GetPrototypesRel().GetForwardedTargets())
        bad = np.flatnonzero((prototypes < 0) | (prototypes >= targets))
        if len(bad):
            message = (
                f"{len(bad)} of {len(prototypes)} instances of {path} are not drawn: protoIndices must be from 0 to "
                f"{targets - 1}, got {prototypes[bad[0]]} at {bad[0]}"
            )
            self._log.add("bad_proto_index", path, message)


def _transforms(instancer: UsdGeom.PointInstancer, time: Usd.TimeCode) -> Sequence[Gf.Matrix4d]:
    """Instancer from prototype root, for each instance: without the prototypes' own transforms, since USD gives nothing at all
    if a single prototype does not exist."""
    return instancer.ComputeInstanceTransformsAtTime(  # type: ignore[no-any-return]
        time, time, UsdGeom.PointInstancer.ExcludeProtoXform, UsdGeom.PointInstancer.IgnoreMask
    )


def _cut(instancer: UsdGeom.PointInstancer, count: int, time: Usd.TimeCode, stage: Usd.Stage) -> UsdGeom.PointInstancer:
    """Copy an instancer to another stage, with the first instances alone. Lists of another type than the schema's are left out.

    USD does not interpolate between two lists of different length. So of two samples of different length the earlier is copied.

    Args:
        instancer: its lists have different lengths.
        count: instances that have all they need.
        time: samples around this time are copied.
        stage: an empty one; the copy lives no longer.
    """
    prim = instancer.GetPrim()
    stage.SetTimeCodesPerSecond(prim.GetStage().GetTimeCodesPerSecond())
    stage.SetInterpolationType(prim.GetStage().GetInterpolationType())
    cut = UsdGeom.PointInstancer.Define(stage, "/cut")
    for name in _LISTS:
        attribute = prim.GetAttribute(name)
        times = attribute.GetBracketingTimeSamples(time.GetValue()) if not time.IsDefault() else ()
        samples = [Usd.TimeCode(each) for each in times] or [time]
        values = [attribute.Get(sample) for sample in samples]
        copy = cut.GetPrim().GetAttribute(name)
        kind = type(copy.GetTypeName().defaultValue)
        usable = [(value, sample) for value, sample in zip(values, samples, strict=True) if isinstance(value, kind)]
        if len({len(value) for value, _ in usable}) > 1:
            usable = usable[:1]
        for value, sample in usable:
            copy.Set(value[:count], sample)
    return cut


def instance_poses(
    chain: Sequence[InstancerLink],
    prim: Usd.Prim,
    transforms: UsdGeom.XformCache,
    world: DoubleArray,
    instances: InstanceReader,
    *,
    drawn: bool = True,
) -> tuple[DoubleArray, IntArray]:
    """Poses of the instances of a surface below one or more point instancers.

    An instance's number is its id, by which USD tells it from the others while they come and go, or its index where its
    instancer has no ids. Nested instancers number theirs by index, as digits: ``outer · (inner count) + inner``.

    Args:
        chain: the instancers, outermost first.
        prim: the surface below the last prototype.
        transforms: transforms at the time.
        world: world from stage.
        instances: reads instancers, at the same time.
        drawn: whether those alone are meant that are visible.

    Returns:
        ``(k, 4, 4)`` world from the prim's own space, and ``(k,)`` instance numbers.

    Raises:
        PlaceError: the transform of the outermost instancer, or of a prim in a prototype, is not finite, or the instances
            multiply beyond all use.
    """
    poses = world_pose(chain[0].instancer, transforms, world)[None]
    numbers = np.zeros(1, np.int32)
    for link, below in zip(chain, [*(next_.instancer for next_ in chain[1:]), prim], strict=True):
        matrices, indices, count = instances.prototype_instances(link, drawn=drawn)
        relative = relative_pose(below, link.root, transforms)
        check_places(len(poses) * len(matrices), link.instancer.GetPath())
        poses = (poses[:, None] @ (matrices @ relative)[None]).reshape(-1, 4, 4)
        numbers = (numbers[:, None] * count + indices[None]).reshape(-1)
    if len(chain) == 1:
        numbers = instances.names(chain[0].instancer)[numbers]
    return poses, numbers


def pose_of_instance(
    chain: Sequence[InstancerLink],
    number: int,
    prim: Usd.Prim,
    transforms: UsdGeom.XformCache,
    world: DoubleArray,
    instances: InstanceReader,
) -> DoubleArray | None:
    """Pose ``(4, 4)`` of one numbered instance, visible or not; None where it does not exist at this time."""
    poses, numbers = instance_poses(chain, prim, transforms, world, instances, drawn=False)
    found = np.flatnonzero(numbers == number)
    return poses[found[0]] if len(found) else None


def is_hidden(hiders: Sequence[Usd.Prim], time: Usd.TimeCode) -> bool:
    """Whether any of these prims, whose visibility varies, is invisible at a time."""
    return any(UsdGeom.Imageable(prim).GetVisibilityAttr().Get(time) == UsdGeom.Tokens.invisible for prim in hiders)


def relative_pose(prim: Usd.Prim, ancestor: Usd.Prim, transforms: UsdGeom.XformCache) -> DoubleArray:
    """Transform ``(4, 4)`` from a prim's own space to that of one of its ancestors, or of itself.

    Raises:
        PlaceError: the transform is not finite.
    """
    if prim == ancestor:
        return np.eye(4)
    matrix, _resets = _computed(lambda: transforms.ComputeRelativeTransform(prim, ancestor))
    relative = column_matrix(matrix)
    if not np.isfinite(relative).all():
        raise _not_finite(_culprit(prim, transforms))
    return relative


def _culprit(prim: Usd.Prim, transforms: UsdGeom.XformCache) -> Usd.Prim:
    """Outermost prim whose own transform is not finite."""
    line = [prim]
    while line[-1].GetParent():
        line.append(line[-1].GetParent())
    for ancestor in reversed(line):
        if UsdGeom.Xformable(ancestor):
            local = column_matrix(transforms.GetLocalTransformation(ancestor)[0])
            if not np.isfinite(local).all():
                return ancestor
    return prim


def _not_finite(prim: Usd.Prim) -> PlaceError:
    path = str(prim.GetPath())
    return PlaceError(f"the transform of {path} must be finite numbers, and is not", code="bad_transform", path=path)
