"""Light and shadow linking: the lights that leave a surface out, by UsdLux's collections ``lightLink`` and ``shadowLink``."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

from pxr import Sdf, Usd, UsdGeom

from render.model.scene import MAX_LINK_SETS, UNLINKED, LightLinks
from render.stage.assembly.inventory import Occurrence
from render.stage.findings import FindingLog
from render.stage.values import UNREADABLE, why_unreadable


def link_surfaces(surfaces: Sequence[Occurrence], lights: Iterable[Usd.Prim], log: FindingLog) -> Sequence[Occurrence]:
    """Surfaces with their links; the same objects where no light leaves anything out.

    A surface in a point instancer belongs to the collections that its outermost instancer belongs to.

    Args:
        surfaces: all surfaces that are drawn.
        lights: light prims, domes too.
        log: for findings.
    """
    queries: dict[str, dict[str, Usd.CollectionMembershipQuery]] = {"lightLink": {}, "shadowLink": {}}
    for prim in lights:
        for name, found in queries.items():
            try:
                if _leaves_out(Usd.CollectionAPI(prim, name)):
                    found[str(prim.GetPath())] = Usd.CollectionAPI(prim, name).ComputeMembershipQuery()
                    _report_subsets(prim, name, log)
            except UNREADABLE as problem:
                path = prim.GetPath()
                message = f"collection {name} of {path} is not honoured: {why_unreadable(problem)}"
                log.add("bad_collection", path, message)
    if not any(queries.values()):
        return surfaces
    known: dict[Sdf.Path, LightLinks] = {}
    sets = {frozenset[str]()}
    linked = []
    for surface in surfaces:
        path = (surface.chain[0].instancer if surface.chain else surface.prim).GetPath()
        if path not in known:
            unlit_by, unshadowed = (
                frozenset(light for light, query in found.items() if not query.IsPathIncluded(path))
                for found in queries.values()
            )
            if unlit_by not in sets and len(sets) >= MAX_LINK_SETS:
                message = f"{path} is lit by all lights: up to {MAX_LINK_SETS} sets of lights are linked"
                log.add("too_many_links", path, message)
                unlit_by = frozenset()
            sets.add(unlit_by)
            known[path] = LightLinks(unlit_by, unshadowed) if unlit_by or unshadowed else UNLINKED
        linked.append(surface if known[path] is UNLINKED else replace(surface, links=known[path]))
    return linked


def _report_subsets(light: Usd.Prim, name: str, log: FindingLog) -> None:
    """Report sets of faces that a collection names: a surface is linked as a whole."""
    collection = Usd.CollectionAPI(light, name)
    for relationship in (collection.GetIncludesRel(), collection.GetExcludesRel()):
        for target in relationship.GetForwardedTargets():
            subset = light.GetStage().GetPrimAtPath(target)
            if subset and subset.IsA(UsdGeom.Subset):
                path = light.GetPath()
                message = f"{name} of {path} names {target}, which counts for nothing: a surface is linked as a whole"
                log.add("linked_subset", path, message)


def _leaves_out(collection: Usd.CollectionAPI) -> bool:
    """Whether a collection may be without some prim; the root is in it unless it says otherwise."""
    return bool(
        not collection.GetIncludeRootAttr().Get()
        or collection.GetExcludesRel().GetForwardedTargets()
        or (collection.GetMembershipExpressionAttr().Get() or Sdf.PathExpression()) != Sdf.PathExpression()
    )
