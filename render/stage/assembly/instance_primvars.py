"""Colours and opacities that prototypes inherit from their point instancers.

As elsewhere in USD, the nearest value wins: a prim's own primvar or one between it and its prototype's root, then those of the
instancers from the innermost outwards, each with what it inherits itself. On an instancer ``vertex``, ``varying`` and
``faceVarying`` primvars have a value for each instance; ``constant`` and ``uniform`` ones have one for all, as in Hydra.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from render import colour
from render.model.arrays import FloatArray, IntArray
from render.stage.assembly.inventory import InstancerLink, Occurrence
from render.stage.assembly.poses import InstanceReader
from render.stage.color_spaces import to_rec709
from render.stage.findings import FindingLog
from render.stage.geometry.primvars import find_primvar
from render.stage.geometry.shape import PrimvarNames

_PER_INSTANCE = ("vertex", "varying", "faceVarying")


@dataclass(frozen=True)
class InstancePrimvars:
    """Names of the primvars that a surface inherits from its point instancers.

    Attributes:
        color: name of the colour that multiplies the material's, or None where it is not theirs.
        opacity: name of the opacity.
        varies: whether either may change over time.
    """

    color: str | None = None
    opacity: str | None = None
    varies: bool = False


NONE_INHERITED = InstancePrimvars()


def inherited_by(surface: Occurrence, primvars: PrimvarNames) -> InstancePrimvars:
    """Primvars of a material that a surface takes from its instancers.

    Args:
        surface: a surface at one place.
        primvars: primvars that its material reads.
    """
    if not surface.chain:
        return NONE_INHERITED
    color, opacity = (
        name if name and _is_theirs(surface, name) else None for name in (primvars.color, primvars.opacity)
    )
    names = [name for name in (color, opacity) if name]
    found = [found for name in names for link in surface.chain if (found := find_primvar(link.instancer, name))]
    return InstancePrimvars(color, opacity, any(each.varies() for each in found)) if names else NONE_INHERITED


def without(primvars: PrimvarNames, inherited: InstancePrimvars) -> PrimvarNames:
    """The primvars that the surface itself has: its vertices are white, and opaque, for those of the instancers."""
    color = None if inherited.color else primvars.color
    return replace(primvars, color=color, opacity=None if inherited.opacity else primvars.opacity)


def instance_colors(
    chain: Sequence[InstancerLink],
    inherited: InstancePrimvars,
    instances: InstanceReader,
    time: Usd.TimeCode,
    log: FindingLog,
) -> FloatArray:
    """Colours ``(k, 4)`` float32 of the instances that `render.stage.assembly.poses.instance_poses` gives, in the working space.

    Args:
        chain: the instancers, outermost first.
        inherited: the primvars that they give.
        instances: reads instancers.
        time: when.
        log: notes primvars that cannot be used.
    """
    colors = np.ones((1, 4), np.float32)
    for link in chain:
        _, indices, count = instances.prototype_instances(link)
        own = np.repeat(colors[:, None], len(indices), axis=1)
        color = _rows(link, inherited.color, 3, indices, count, time, log)
        if color is not None:
            found = find_primvar(link.instancer, str(inherited.color))
            linear = color if found is None else to_rec709(color, found.primvar.GetAttr(), log)
            own[..., :3] = colour.to_working(linear)
        opacity = _rows(link, inherited.opacity, 1, indices, count, time, log)
        if opacity is not None:
            own[..., 3] = opacity[:, 0]
        colors = own.reshape(-1, 4)
    return np.nan_to_num(colors)


def _is_theirs(surface: Occurrence, name: str) -> bool:
    """Whether a primvar comes from an instancer rather than from the prototype."""
    own = find_primvar(surface.prim, name)
    root = surface.chain[-1].root.GetPath()
    if own is not None and own.primvar.GetAttr().GetPath().HasPrefix(root):
        return False
    return any(find_primvar(link.instancer, name) is not None for link in surface.chain)


def _rows(
    link: InstancerLink,
    name: str | None,
    width: int,
    indices: IntArray,
    count: int,
    time: Usd.TimeCode,
    log: FindingLog,
) -> FloatArray | None:
    """Values ``(k, width)`` of a primvar for some instances of an instancer; None where it has none that can be used.

    Args:
        link: the instancer.
        name: of the primvar; None for none.
        width: numbers of each value.
        indices: ``(k,)`` of the instances.
        count: of all instances, which must all have a value.
        time: when.
        log: for findings.
    """
    found = find_primvar(link.instancer, name) if name else None
    if found is None:
        return None
    path, values = link.instancer.GetPath(), found.read(time, width)
    if values is None or not len(values.values):
        message = f"primvar {name} of {path} is not used: it does not hold {width} numbers for each element"
        log.add(f"bad_primvar_{name}", path, message)
        return None
    is_own = values.interpolation in _PER_INSTANCE
    needed = count if is_own else min(count, 1)
    listed = np.arange(len(values.values)) if values.indices is None else values.indices
    used = listed[:needed]
    if len(used) < needed or used.min(initial=0) < 0 or used.max(initial=0) >= len(values.values):
        message = f"primvar {name} of {path} is not used: it has {len(values.values)} values for {count} instances"
        log.add(f"bad_primvar_{name}", path, message)
        return None
    return values.values[used[indices] if is_own else used[np.zeros(len(indices), np.int64)]]
