"""Light and shadow linking: the lights that leave a surface, or some of its faces, out, by UsdLux's collections ``lightLink`` and
``shadowLink``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from pxr import Sdf, Usd, UsdGeom

from render.model.scene import MAX_LINK_SETS, UNLINKED, LightLinks
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.linked_faces import MAX_SUBSETS, LinkedFaces, find_patterns
from render.stage.findings import FindingLog
from render.stage.values import UNREADABLE, why_unreadable

_COLLECTIONS = "lightLink", "shadowLink"
_Said = dict[tuple[str, str], bool]
"""Whether a collection holds something, by the collection's name and the light's path."""


@dataclass(frozen=True, eq=False)
class _Members:
    """Members of one collection.

    Attributes:
        query: asks for them.
        named: paths that the collection names, one by one.
        is_expression: whether it is a path expression.
    """

    query: Usd.CollectionMembershipQuery
    named: frozenset[Sdf.Path]
    is_expression: bool

    def held_subsets(self, subsets: Sequence[Sdf.Path], is_mesh_held: bool) -> dict[Sdf.Path, bool]:
        """Whether geom subsets of a mesh are in it, of those that are not as the mesh.

        An expression that holds a mesh may speak of its subsets or not: it does if it names one, or holds any.

        Args:
            subsets: all of the mesh.
            is_mesh_held: whether the mesh is in it.
        """
        asked = [path for path in subsets if self.is_expression or path in self.named]
        held = {path: bool(self.query.IsPathIncluded(path)) for path in asked}
        has_some = any(held.values())
        return {
            path: is_held
            for path, is_held in held.items()
            if path in self.named or (has_some and is_held != is_mesh_held)
        }


def link_surfaces(surfaces: Sequence[Occurrence], lights: Iterable[Usd.Prim], log: FindingLog) -> Sequence[Occurrence]:
    """Surfaces with their links; the same objects where no light leaves anything out.

    A mesh of which a collection holds a geom subset alone, or leaves one out, becomes several surfaces, each of the faces that
    are linked alike. Of several such subsets that have a face, one that is left out decides. A surface in a point instancer
    belongs to the collections that its outermost instancer belongs to.

    Args:
        surfaces: all surfaces that are drawn.
        lights: light prims, domes too.
        log: for findings.
    """
    linker = _Linker(lights, log)
    if not linker.members:
        return surfaces
    linked = [part for surface in surfaces for part in linker.link(surface)]
    linker.note_unused()
    return linked


class _Linker:
    def __init__(self, lights: Iterable[Usd.Prim], log: FindingLog) -> None:
        self._log = log
        self.members: dict[tuple[str, str], _Members] = {}
        self._known: dict[Sdf.Path, LightLinks] = {}
        self._sets = {frozenset[str]()}
        self._subsets: dict[Sdf.Path, tuple[UsdGeom.Subset, str, Sdf.Path]] = {}  # those named, and by whom
        self._surfaces: set[Sdf.Path] = set()  # parents of these
        self._repeated: set[Sdf.Path] = set()  # those of the surfaces that point instancers repeat
        for prim in lights:
            for name in _COLLECTIONS:
                try:
                    if _leaves_out(Usd.CollectionAPI(prim, name)):
                        self._add(prim, name)
                except UNREADABLE as problem:
                    path = prim.GetPath()
                    message = f"collection {name} of {path} is not honoured: {why_unreadable(problem)}"
                    log.add("bad_collection", path, message)
        self._asks_all = any(members.is_expression for members in self.members.values())

    def _add(self, light: Usd.Prim, name: str) -> None:
        collection = Usd.CollectionAPI(light, name)
        query = collection.ComputeMembershipQuery()
        is_expression = not query.UsesPathExpansionRuleMap()
        named = _named_paths(collection) if is_expression else frozenset(query.GetAsPathExpansionRuleMap())
        self.members[name, str(light.GetPath())] = _Members(query, named, is_expression)
        for path in named:
            subset = light.GetStage().GetPrimAtPath(path) if path.IsPrimPath() else None
            if subset and subset.IsA(UsdGeom.Subset):
                self._subsets[path] = UsdGeom.Subset(subset), name, light.GetPath()
                self._surfaces.add(path.GetParentPath())

    def link(self, surface: Occurrence) -> Iterator[Occurrence]:
        """The surface with its links, or parts of it with theirs."""
        path = (surface.chain[0].instancer if surface.chain else surface.prim).GetPath()
        whole = {key: bool(members.query.IsPathIncluded(path)) for key, members in self.members.items()}
        if path not in self._known:
            self._known[path] = self._links(whole, path)
        links = self._known[path]
        if surface.chain:
            self._repeated.add(surface.prim.GetPath())
        said = {} if surface.chain or surface.draw_mode else self._said_of_subsets(surface.prim, whole)
        groups = tuple(said)
        try:
            patterns = sorted(find_patterns(surface.prim, groups, self._log)) if said else []
        except UNREADABLE as problem:
            message = f"{surface.path} is linked as a whole: {why_unreadable(problem)}"
            self._log.add("bad_subset", surface.path, message)
            patterns = []
        alike: dict[LightLinks, set[int]] = {}
        for pattern in patterns:
            held = [own for number, own in enumerate(said.values()) if pattern >> number & 1]
            alike.setdefault(self._links(_together(whole, held), path) if held else links, set()).add(pattern)
        if len(alike) < 2:
            links = next(iter(alike), links)
            yield surface if links is UNLINKED else replace(surface, links=links)
        else:
            for own, which in alike.items():
                yield replace(surface, links=own, linked_faces=LinkedFaces(groups, frozenset(which)))

    def note_unused(self) -> None:
        """Note each subset that is named and counts for nothing."""
        for path, (subset, name, light) in self._subsets.items():
            mesh = path.GetParentPath()
            is_cut = subset.GetElementTypeAttr().Get() == UsdGeom.Tokens.face and subset.GetPrim().GetParent().IsA(
                UsdGeom.Mesh
            )
            if not is_cut or mesh in self._repeated:
                why = "only faces of meshes that no point instancer repeats are linked"
                message = f"{name} of {light} names {path}, which counts for nothing: {why}"
                self._log.add("linked_subset", light, message)

    def _said_of_subsets(self, prim: Usd.Prim, whole: _Said) -> dict[tuple[str, ...], _Said]:
        """Whether collections hold a mesh's subsets, by the names of those alike: where it is not as the mesh."""
        if not (self._asks_all or prim.GetPath() in self._surfaces) or not prim.IsA(UsdGeom.Mesh):
            return {}
        subsets = UsdGeom.Subset.GetAllGeomSubsets(UsdGeom.Imageable(prim))
        paths = [one.GetPath() for one in subsets if one.GetElementTypeAttr().Get() == UsdGeom.Tokens.face]
        said: dict[Sdf.Path, _Said] = {}
        for key, members in self.members.items():
            for path, is_held in members.held_subsets(paths, whole[key]).items():
                said.setdefault(path, {})[key] = is_held
        alike: dict[frozenset[tuple[tuple[str, str], bool]], list[str]] = {}
        for path in (path for path in paths if path in said):
            alike.setdefault(frozenset(said[path].items()), []).append(path.name)
        if len(alike) > MAX_SUBSETS:
            message = f"{prim.GetPath()} is linked by {MAX_SUBSETS} unlike geom subsets alone: it has {len(alike)}"
            self._log.add("too_many_links", prim.GetPath(), message)
        return {tuple(names): dict(own) for own, names in list(alike.items())[:MAX_SUBSETS]}

    def _links(self, said: _Said, path: Sdf.Path) -> LightLinks:
        unlit_by, unshadowed = (
            frozenset(light for (name, light), is_held in said.items() if name == wanted and not is_held)
            for wanted in _COLLECTIONS
        )
        if unlit_by not in self._sets and len(self._sets) >= MAX_LINK_SETS:
            message = f"{path} is lit by all lights: up to {MAX_LINK_SETS} sets of lights are linked"
            self._log.add("too_many_links", path, message)
            unlit_by = frozenset()
        self._sets.add(unlit_by)
        return LightLinks(unlit_by, unshadowed) if unlit_by or unshadowed else UNLINKED


def _together(whole: _Said, held: Sequence[_Said]) -> _Said:
    """Whether collections hold a face that is in several subsets."""
    said = {key: [one[key] for one in held if key in one] for key in whole}
    return {key: all(own) if (own := said[key]) else is_held for key, is_held in whole.items()}


def _named_paths(collection: Usd.CollectionAPI) -> frozenset[Sdf.Path]:
    """Paths that a collection's path expression names one by one, without wildcards."""
    patterns: list[Sdf.PathPattern] = []
    collection.ResolveCompleteMembershipExpression().Walk(lambda *_: True, lambda _: True, patterns.append)
    return frozenset(one.GetPrefix() for one in patterns if one.GetText() == str(one.GetPrefix()))


def _leaves_out(collection: Usd.CollectionAPI) -> bool:
    """Whether a collection may be without some prim; the root is in it unless it says otherwise."""
    return bool(
        not collection.GetIncludeRootAttr().Get()
        or collection.GetExcludesRel().GetForwardedTargets()
        or (collection.GetMembershipExpressionAttr().Get() or Sdf.PathExpression()) != Sdf.PathExpression()
    )
