"""Places of Gaussian splats: their boxes, of which USD computes no extent where none is authored, and where single ones are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import islice

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom

from render.model.arrays import DoubleArray
from render.stage.geometry.polygons import FARTHEST_POINT, BadGeometry
from render.stage.values import SPLATS, UNREADABLE, schema_type, why_unreadable

EXTENT_SIGMAS = 3.0
"""Standard deviations of a splat that count as its extent."""
MOST_CLOUDS = 2_000
"""Clouds of splats without an extent, instances among them, that a box is computed of."""


def splat_extent(prim: Usd.Prim, time: Usd.TimeCode) -> DoubleArray | None:
    """Least and greatest corner ``(2, 3)`` of a prim's splats in its own space and units, as far as three standard deviations.

    Args:
        prim: a ParticleField3DGaussianSplat.
        time: when.

    Returns:
        The box; None where the prim has no splats that can be read.
    """
    from render.stage.geometry.splats import read_ellipsoids  # few shots need it

    try:
        positions, axes = read_ellipsoids(prim, time)
    except (BadGeometry, *UNREADABLE):
        return None
    with np.errstate(invalid="ignore", over="ignore"):
        reach = EXTENT_SIGMAS * np.sqrt((axes.astype(np.float64) ** 2).sum(axis=2))
        low, high = positions - reach, positions + reach
        usable = (np.abs(low) <= FARTHEST_POINT).all(axis=1) & (np.abs(high) <= FARTHEST_POINT).all(axis=1)
    if not usable.any():
        return None
    return np.array([low[usable].min(axis=0), high[usable].max(axis=0)])


def splats_move(prim: Usd.Prim) -> bool:
    """Whether a prim's splats may move over time in its own space."""
    attributes = (prim.GetAttribute(name) for name in ("positions", "positionsh"))
    return any(attribute and attribute.ValueMightBeTimeVarying() for attribute in attributes)


def splat_place(prim: Usd.Prim, number: int, time: Usd.TimeCode) -> DoubleArray | None:
    """Middle ``(3,)`` of one of a prim's splats in its own space and units; None where there is none of that number.

    Raises:
        BadGeometry: the positions are no list of points, too many, or that of the splat is not finite.
    """
    from render.stage.geometry.splats import read_positions  # few shots need it

    try:
        positions = read_positions(prim, time)
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem
    if not 0 <= number < len(positions):
        return None
    if not np.isfinite(positions[number]).all():
        raise BadGeometry("the place of its splat is not finite")
    return np.asarray(positions[number], np.float64)


def box_below(root: Usd.Prim, time: Usd.TimeCode, purposes: Sequence[str]) -> Gf.Range3d:
    """Box around all that is visible at and below a prim, splats without an extent included, in the prim's own space and units.

    Splats that a PointInstancer repeats count only with an extent of theirs, and of many clouds the first `MOST_CLOUDS`.

    Args:
        root: the prim, which may be the stage's root.
        time: when.
        purposes: purposes that count.

    Returns:
        The box, empty where there is nothing.
    """
    boxes = UsdGeom.BBoxCache(time, list(purposes), useExtentsHint=True)
    found = boxes.ComputeUntransformedBound(root) if root.GetPath().IsPrimPath() else boxes.ComputeWorldBound(root)
    box = found.ComputeAlignedRange()
    holders: dict[Sdf.Path, bool] = {}
    if not _holds_splats(root, holders):
        return box
    transforms, extents = UsdGeom.XformCache(time), dict[Sdf.Path, DoubleArray | None]()
    for prim in islice(_splats_below(root, holders), MOST_CLOUDS):
        shared = prim.GetPrimInPrototype().GetPath() if prim.IsInstanceProxy() else prim.GetPath()
        if shared not in extents:
            extents[shared] = splat_extent(prim, time)
        extent = extents[shared]
        if extent is None or not _is_boxed(prim, root, time, purposes):
            continue
        to_root, _ = transforms.ComputeRelativeTransform(prim, root)
        own = Gf.Range3d(Gf.Vec3d(*extent[0].tolist()), Gf.Vec3d(*extent[1].tolist()))
        box.UnionWith(Gf.BBox3d(own, to_root).ComputeAlignedRange())
    return box


def _holds_splats(root: Usd.Prim, holders: dict[Sdf.Path, bool]) -> bool:
    """Whether a prim is or holds splats, each prototype being asked once; those are added to the holders."""
    found = False
    prims = iter(Usd.PrimRange(root))
    for prim in prims:
        kind = schema_type(prim)
        found = found or kind == SPLATS
        if kind == "PointInstancer":
            prims.PruneChildren()
        elif prim.IsInstance():
            prototype = prim.GetPrototype()
            path = prototype.GetPath()
            if path not in holders:
                holders[path] = False  # prototypes hold no loops
                holders[path] = _holds_splats(prototype, holders)
            found = found or holders[path]
    return found


def _splats_below(root: Usd.Prim, holders: Mapping[Sdf.Path, bool]) -> Iterator[Usd.Prim]:
    """Splats at and below a prim, those of instances too; instances that hold none are passed over."""
    prims = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies()))
    for prim in prims:
        kind = schema_type(prim)
        is_bare = prim.IsInstance() and not holders.get(prim.GetPrototype().GetPath(), True)
        if kind == "PointInstancer" or is_bare:
            prims.PruneChildren()
        if kind == SPLATS:
            yield prim


def _is_boxed(prim: Usd.Prim, root: Usd.Prim, time: Usd.TimeCode, purposes: Sequence[str]) -> bool:
    """Whether splats count, and neither an extent of their own nor a hint of a model up to the root stands for them."""
    shape = UsdGeom.Imageable(prim)
    if UsdGeom.Boundable(prim).GetExtentAttr().HasAuthoredValue() or shape.ComputePurpose() not in purposes:
        return False
    if shape.ComputeVisibility(time) == UsdGeom.Tokens.invisible:
        return False
    while prim.GetPath().IsPrimPath():
        hint = UsdGeom.ModelAPI(prim).GetExtentsHintAttr()
        if prim.IsModel() and hint and hint.HasAuthoredValue():
            return False
        if prim == root:
            break
        prim = prim.GetParent()
    return True
