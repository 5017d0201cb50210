"""Make a focus point from what a click hit, so that it follows the surface."""

from __future__ import annotations

from typing import Protocol

from usd_schemas import FocusPoint


class Picked(Protocol):
    """Surface under a click, such as `render.frame.Pick`."""

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


def make_point(name: str, picked: Picked) -> FocusPoint:
    """Make a sharp focus point at the spot that was hit.

    Args:
        name: of the new point.
        picked: the surface that was hit.
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
