"""Rules for focus points: their targets are there, and what they say of them can be."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pxr import Sdf, Tf, Usd, UsdGeom, Vt

from usd_schemas.errors import SchemaError
from usd_schemas.focus_point import FocusPointView
from usd_schemas.settings import FocusPoint
from usd_schemas.topology import topology_change
from usd_schemas.validation.rule import Fault, Fix, Rule, authored_values
from usd_schemas.values import is_animated, read_value
from usd_schemas.view import LensCamera

_TOLERANCE = 1e-6  # of barycentric coordinates, which tools may have written in single precision
_FAR = 1.0  # sizes of the bounds: a bent mesh may stand out of its bounds at rest


def focus_mode(prim: Usd.Prim) -> Iterator[Fault]:
    """A camera that focuses by points has some."""
    camera = LensCamera(prim)
    mode = camera.focus.read().mode
    if mode != "manual" and not camera.focus_points():
        path = prim.GetPath().AppendProperty("focus:mode")
        yield Fault(path, f"focus:mode is {mode}, which needs focus points; the camera has none")


def targets(prim: Usd.Prim) -> Iterator[Fault]:
    """Each focus point's target is there and of a kind that can be anchored to."""
    for view in LensCamera(prim).focus_points():
        relationship = view.target_relationship()
        try:
            paths = view.read().target
        except SchemaError as problem:
            at_fault = next((one for one in view.relationships() if not _has_targets(one)), relationship)
            yield Fault(at_fault.GetPath(), str(problem))
            continue
        if view.read().part:
            continue  # the place of the point depends on that alone
        if len(paths) not in (1, 2):
            yield Fault(
                relationship.GetPath(),
                f"focus point {view.name} needs one target, or a PointInstancer and its prototype's mesh, "
                f"got {len(paths)}",
            )
            continue
        for path in paths:
            target = prim.GetStage().GetPrimAtPath(path)
            if not target:
                yield Fault(
                    relationship.GetPath(), f"focus point {view.name} has the target {path}, which is not there"
                )
            elif not target.IsA(UsdGeom.Xformable):
                kind = target.GetTypeName() or "no type"
                yield Fault(
                    relationship.GetPath(),
                    f"focus point {view.name} needs an Xformable as its target, got {path} of {kind}",
                )


def _has_targets(relationship: Usd.Relationship) -> bool:
    """Whether a relationship can be read, and is not authored as an attribute."""
    try:
        relationship.GetTargets()
    except Tf.ErrorException:
        return False
    return True


def parts(prim: Usd.Prim) -> Iterator[Fault]:
    """The part whose bounds a focus point follows is one prim that is there."""
    for view in LensCamera(prim).focus_points():
        try:
            part = view.read().part
        except SchemaError:
            continue  # which the rule of targets says
        path, paths = view.part_relationship().GetPath(), view.part_relationship().GetTargets()
        found = prim.GetStage().GetPrimAtPath(part) if part else None
        if len(paths) > 1:
            yield Fault(path, f"focus point {view.name} follows the bounds of one part, got {len(paths)}")
        elif part and not found:
            yield Fault(path, f"focus point {view.name} follows the bounds of {part}, which is not there")
        elif found and not found.IsActive():
            yield Fault(path, f"focus point {view.name} follows the bounds of {part}, which is deactivated")


def places_in_bounds(prim: Usd.Prim) -> Iterator[Fault]:
    """A focus point that follows bounds lies in them, or not far away."""
    for view in LensCamera(prim).focus_points():
        relationship = view.part_relationship()
        if not _has_targets(relationship) or not relationship.GetTargets():
            continue
        attribute = prim.GetAttribute(f"focusPoint:{view.name}:boundsPoint")
        for where, place in authored_values(attribute):
            if not all(-_FAR <= ratio <= 1 + _FAR for ratio in place):
                yield Fault(
                    attribute.GetPath(),
                    f"the place of focus point {view.name}{where} in the bounds that it follows is expected from 0 to 1, "
                    f"or at most {_FAR:g} outside, got {place}",
                )


def anchors(prim: Usd.Prim) -> Iterator[Fault]:
    """Face, triangle and instance of each focus point exist on its target."""
    for view in LensCamera(prim).focus_points():
        try:
            point = view.read(_first_time(view))
        except SchemaError:
            continue
        if point.part:
            continue
        yield from _instance_fault(view, point)
        mesh = _mesh(prim.GetStage(), point)
        if mesh is None or point.face < 0:
            continue
        counts = _whole_numbers(mesh.GetFaceVertexCountsAttr())
        path = prim.GetPath().AppendProperty(f"focusPoint:{view.name}:face")
        if point.face >= len(counts):
            yield Fault(
                path, f"focus point {view.name}: {mesh.GetPath()} has {len(counts)} faces, got face {point.face}"
            )
        elif point.fan_triangle >= counts[point.face] - 2:
            fan = path.ReplaceName(f"focusPoint:{view.name}:fanTriangle")
            yield Fault(
                fan,
                f"focus point {view.name}: face {point.face} of {mesh.GetPath()} has {max(counts[point.face] - 2, 0)} "
                f"triangles, got triangle {point.fan_triangle}",
            )


def _first_time(view: FocusPointView) -> float | None:
    """The time of the point's first key of face or instance, None where they do not change."""
    times = [key.time for name in ("face", "instance", "fan_triangle") for key in view.keys(name)]
    return min(times, default=None)


def _instance_fault(view: FocusPointView, point: FocusPoint) -> Iterator[Fault]:
    first = point.target[0] if point.target else "/"
    instancer = UsdGeom.PointInstancer(view.prim.GetStage().GetPrimAtPath(first))
    path = view.prim.GetPath().AppendProperty(f"focusPoint:{view.name}:instance")
    if instancer:
        fault = _instance_problem(instancer, point)
        if fault:
            yield Fault(path, f"focus point {view.name}: {fault}")
    elif point.instance >= 0:
        yield Fault(
            path, f"focus point {view.name} names instance {point.instance} of a target that is no PointInstancer"
        )


def _instance_problem(instancer: UsdGeom.PointInstancer, point: FocusPoint) -> str:
    """Describe the fault of a focus point's instance at the instancer's first sample; empty where there is none."""
    where = instancer.GetPath()
    if point.instance < 0:
        return f"{where} is a PointInstancer, whose instance must be named, got {point.instance}"
    ids = instancer.GetIdsAttr()
    if ids.ValueMightBeTimeVarying():
        return ""  # it may come later
    known = set(ids.Get(Usd.TimeCode.EarliestTime()) or [])
    if known:
        return "" if point.instance in known else f"{where} has no instance of id {point.instance}"
    count = len(_whole_numbers(instancer.GetProtoIndicesAttr()))
    below = Usd.PrimRange.AllPrims(instancer.GetPrim())
    nested = sum(prim.IsA(UsdGeom.PointInstancer) for prim in below) > 1
    return "" if nested or point.instance < count else f"{where} has {count} instances, got {point.instance}"


def _whole_numbers(attribute: Usd.Attribute) -> Vt.IntArray:
    """The first value of an array of int, empty where a layer has something else there."""
    value = attribute.Get(Usd.TimeCode.EarliestTime())
    return value if isinstance(value, Vt.IntArray) else Vt.IntArray()


def _mesh(stage: Usd.Stage, point: FocusPoint) -> UsdGeom.Mesh | None:
    target = stage.GetPrimAtPath(point.target[-1]) if point.target else None
    return UsdGeom.Mesh(target) if target and target.IsA(UsdGeom.Mesh) else None


def topology(prim: Usd.Prim) -> Iterator[Fault]:
    """The target mesh still has the topology on which the focus point was placed."""
    for view in LensCamera(prim).focus_points():
        try:
            point = view.read()
        except SchemaError:
            continue  # its target is no relationship, which the rule of targets says
        changed = topology_change(prim.GetStage(), point)
        if changed is not None:
            yield Fault(prim.GetPath().AppendProperty(f"focusPoint:{view.name}:topology"), changed)


def barycentrics(prim: Usd.Prim) -> Iterator[Fault]:
    """Barycentric coordinates sum to 1 and lie in the triangle."""
    for view in LensCamera(prim).focus_points():
        attribute = prim.GetAttribute(f"focusPoint:{view.name}:barycentric")
        for where, weights in authored_values(attribute):
            if abs(sum(weights) - 1) > _TOLERANCE or min(weights) < -_TOLERANCE:
                yield Fault(
                    attribute.GetPath(),
                    f"barycentric coordinates of focus point {view.name}{where} must be 0 or more and sum to 1, "
                    f"got {weights}",
                )


def _can_normalise(stage: Usd.Stage, path: Sdf.Path) -> bool:
    attribute = stage.GetAttributeAtPath(path)
    if not attribute or is_animated(attribute):
        return False
    weights = read_value(attribute) or (0.0, 0.0, 0.0)
    return math.isfinite(sum(weights)) and min(weights) >= -_TOLERANCE and sum(weights) > 0


def _normalise(stage: Usd.Stage, path: Sdf.Path) -> None:
    attribute = stage.GetAttributeAtPath(path)
    weights = [max(weight, 0.0) for weight in read_value(attribute)]
    attribute.Set(tuple(weight / sum(weights) for weight in weights))


FOCUS_RULES = (
    Rule("FocusMode", focus_mode.__doc__ or "", "warning", "camera", focus_mode),
    Rule("FocusPointTargets", targets.__doc__ or "", "error", "camera", targets),
    Rule("FocusPointParts", parts.__doc__ or "", "error", "camera", parts),
    Rule("FocusPointPlaces", places_in_bounds.__doc__ or "", "warning", "camera", places_in_bounds),
    Rule("FocusPointAnchors", anchors.__doc__ or "", "error", "camera", anchors),
    Rule("FocusPointTopology", topology.__doc__ or "", "warning", "camera", topology),
    Rule(
        "FocusPointBarycentrics",
        barycentrics.__doc__ or "",
        "error",
        "camera",
        barycentrics,
        Fix("Normalise", "Scale coordinates that do not change over time to sum to 1.", _can_normalise, _normalise),
    ),
)
