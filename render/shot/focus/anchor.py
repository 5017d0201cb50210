"""Make a focus point from what a click hit, so that it follows the surface."""

from __future__ import annotations

from typing import Protocol

from pxr import Sdf, Usd, UsdGeom

from render.errors import SettingsError
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


def check_has_face(stage: Usd.Stage, point: FocusPoint) -> None:
    """Refuse a focus point on a back plate, which picking gives as a face of its camera: the plate follows the focus itself.

    Args:
        stage: the stage.
        point: the point.

    Raises:
        SettingsError: it is on one; code ``on_back_plate``.
    """
    path = point.target[-1] if point.target else ""
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    if point.face != -1 and prim and prim.IsA(UsdGeom.Camera):
        raise SettingsError(
            f"focus point {point.name} is on a back plate of {path}, which follows the focus: set the focus distance instead",
            code="on_back_plate",
            path=path,
        )
