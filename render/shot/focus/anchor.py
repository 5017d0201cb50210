"""Make a focus point from what a click hit, so that it follows the surface."""

from __future__ import annotations

from typing import Protocol

from usd_schemas import FocusPoint


class SurfacePoint(Protocol):
    """Point of a surface under a click, such as `render.frame.Pick`."""

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


def make_point(name: str, surface: SurfacePoint) -> FocusPoint:
    """Make a sharp focus point at the spot that was hit.

    Args:
        name: of the new point.
        surface: point of the surface that was hit.
    """
    target = (surface.prim_path,) if surface.prototype_path is None else (surface.prim_path, surface.prototype_path)
    a, b, c = (float(weight) for weight in surface.barycentric)
    return FocusPoint(
        name=name,
        target=target,
        face=int(surface.face),
        fan_triangle=int(surface.fan_triangle),
        barycentric=(a, b, c),
        instance=int(surface.instance),
    )
