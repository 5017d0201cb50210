"""From what a click hit to a focus point that follows it."""

from __future__ import annotations

from typing import Protocol

from usd_schemas import FocusPoint


class Picked(Protocol):
    """What a click hit; `render.frame.Pick` is one."""

    @property
    def prim_path(self) -> str: ...
    @property
    def prototype_path(self) -> str | None: ...
    @property
    def face(self) -> int: ...
    @property
    def fan_triangle(self) -> int: ...
    @property
    def barycentric(self) -> tuple[float, float, float]: ...
    @property
    def instance(self) -> int: ...


def anchored(name: str, picked: Picked) -> FocusPoint:
    """A sharp focus point on the very spot that was hit.

    Args:
        name: the new point's name.
        picked: what was hit.
    """
    target = (picked.prim_path,) if picked.prototype_path is None else (picked.prim_path, picked.prototype_path)
    a, b, c = (float(weight) for weight in picked.barycentric)
    return FocusPoint(
        name=name,
        target=target,
        face=int(picked.face),
        fan_triangle=int(picked.fan_triangle),
        barycentric=(a, b, c),
        instance=int(picked.instance),
    )
