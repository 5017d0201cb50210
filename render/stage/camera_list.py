"""Which cameras a stage has, without a walk through instances that have none."""

from __future__ import annotations

from pxr import Usd, UsdGeom

from render.stage.limits import PrimCount


def list_cameras(stage: Usd.Stage) -> list[str]:
    """Paths of all cameras on the stage, those in native instances included, in the order of the stage.

    Raises:
        StageError: instances within instances multiply to more cameras than can be walked; code ``too_many_prims``.
    """
    with_cameras: dict[str, bool] = {}
    instanced = PrimCount()
    found = []
    prims = iter(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)))
    for prim in prims:
        if prim.IsInstance() and not _has_camera(prim.GetPrototype(), with_cameras):
            prims.PruneChildren()
        if prim.IsInstanceProxy():
            instanced.add(prim.GetPath())
        if prim.IsA(UsdGeom.Camera):
            found.append(str(prim.GetPath()))
    return found


def _has_camera(prototype: Usd.Prim, known: dict[str, bool]) -> bool:
    """Whether there is a camera in a native prototype, or in prototypes that it instances; each is walked once."""
    path = str(prototype.GetPath())
    if path not in known:
        known[path] = any(
            prim.IsA(UsdGeom.Camera) or (prim.IsInstance() and _has_camera(prim.GetPrototype(), known))
            for prim in Usd.PrimRange(prototype)
        )
    return known[path]
