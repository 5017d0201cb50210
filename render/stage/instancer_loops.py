"""Point instancers that are among their own prototypes: USD follows them without end."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdGeom


def find_instancer_loop(stage: Usd.Stage) -> Sdf.Path | None:
    """Path of an instancer that is at or below one of its prototypes, or of the prototypes of instancers there; None for none."""
    instancers = [UsdGeom.PointInstancer(prim) for prim in stage.TraverseAll() if prim.IsA(UsdGeom.PointInstancer)]
    paths = [instancer.GetPath() for instancer in instancers]
    below = {
        path: [other for target in _prototypes(instancer) for other in paths if other.HasPrefix(target)]
        for path, instancer in zip(paths, instancers, strict=True)
    }
    for path in paths:
        seen, waiting = set[Sdf.Path](), list(below[path])
        while waiting:
            other = waiting.pop()
            if other == path:
                return path
            if other not in seen:
                seen.add(other)
                waiting += below[other]
    return None


def _prototypes(instancer: UsdGeom.PointInstancer) -> list[Sdf.Path]:
    return list(instancer.GetPrototypesRel().GetForwardedTargets())
