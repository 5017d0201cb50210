"""Size of a composition, judged by the arcs of its layers before USD composes them: doubled twenty times, one prim is a million.

Counted are the opinions that the prims of a stage will have: each prim once for each arc on the way to it. Of a variant set the
largest variant counts; what is instanceable counts once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from pxr import Sdf

from render.errors import StageError

MAX_OPINIONS = 4_000_000  # about 3 GB
MAX_LAYERS = 20_000  # of one layer stack, each as often as it is a sublayer
MAX_ARC_DEPTH = 150  # references to what refers to what …
MAX_CLIPS = 100_000
_ROOT = Sdf.Path.absoluteRootPath
_ARCS = frozenset({"references", "payload", "inheritPaths", "specializes"})
_VARIANTS = "variantSetNames"
FindLayer = Callable[[Sdf.Layer, str], "Sdf.Layer | None"]
"""Finds a layer by an asset path in another layer; None where there is none."""


@dataclass(frozen=True)
class _Size:
    """Number of prims and of the opinions on them."""

    prims: int = 0
    opinions: int = 0

    def __add__(self, other: _Size) -> _Size:
        return _Size(self.prims + other.prims, self.opinions + other.opinions)

    def through_arc(self) -> _Size:
        """Size as seen by what refers to it."""
        return _Size(self.prims, self.opinions + self.prims)


@dataclass(frozen=True)
class _Arcs:
    """Arcs and variants of one prim of a layer.

    Attributes:
        targets: layer that is referred to, None for its own stack, and the path there, empty for the default prim.
        variants: for each variant set, the paths of its variants.
        is_instance: whether the prim is instanceable.
    """

    targets: tuple[tuple[str | None, Sdf.Path], ...]
    variants: tuple[tuple[Sdf.Path, ...], ...]
    is_instance: bool


@dataclass
class _Outline:
    """Prims of a layer in depth-first order.

    Attributes:
        spans: for each prim path, its place in the order and that of the first prim after it.
        arcs: arcs by their places, in order.
    """

    spans: dict[Sdf.Path, tuple[int, int]] = field(default_factory=dict)
    arcs: list[tuple[int, _Arcs]] = field(default_factory=list)


class CompositionSize:
    """Judges the composition of a stage.

    Args:
        find: finds layers.
    """

    def __init__(self, find: FindLayer) -> None:
        self._find = find
        self._outlines: dict[str, _Outline] = {}
        self._layers: dict[str, Sdf.Layer] = {}
        self._stacks: dict[str, list[str]] = {}
        self._sizes: dict[tuple[str, Sdf.Path], _Size | None] = {}
        self._prototypes = _Size()

    def check(self, root: Sdf.Layer) -> None:
        """Judge the stage of a root layer.

        Raises:
            StageError: code ``too_many_prims``.
        """
        self._layers[root.identifier] = root
        size = self._size(root.identifier, _ROOT, 0) + self._prototypes
        if size.opinions > MAX_OPINIONS:
            raise _too_large(f"its references multiply to {size.opinions:,} opinions, more than {MAX_OPINIONS:,}")

    def _size(self, stack: str, path: Sdf.Path, depth: int) -> _Size:
        """Size of a subtree of a layer stack."""
        if depth > MAX_ARC_DEPTH:
            raise _too_large(f"its references are nested more than {MAX_ARC_DEPTH} deep, at {path}")
        key = stack, path
        if key not in self._sizes:
            self._sizes[key] = None  # USD refuses circles
            size = _Size()
            for name in self._stack(stack):
                size += self._size_in_layer(self._outline(name), stack, path, depth)
            self._sizes[key] = size if size.opinions <= MAX_OPINIONS else _Size(MAX_OPINIONS + 1, MAX_OPINIONS + 1)
        return self._sizes[key] or _Size()

    def _size_in_layer(self, outline: _Outline, stack: str, path: Sdf.Path, depth: int) -> _Size:
        while path not in outline.spans:  # what an ancestor's arcs bring is part of the ancestor's size
            if path.IsAbsoluteRootPath():
                return _Size()
            path = path.GetParentPath()
        first, last = outline.spans[path]
        size = _Size(last - first, last - first)
        for place, arcs in outline.arcs:
            if first <= place < last:
                size += self._size_of_arcs(arcs, stack, depth + 1)
        return size

    def _size_of_arcs(self, arcs: _Arcs, stack: str, depth: int) -> _Size:
        size = _Size()
        for layer, path in arcs.targets:
            target = stack if layer is None else layer
            key = target, path
            if arcs.is_instance:
                if key not in self._sizes:
                    self._prototypes += self._size(target, path, depth)
                size += _Size(0, 1)
            else:
                size += self._size(target, path, depth).through_arc()
        for variants in arcs.variants:
            size += max((self._size(stack, variant, depth) for variant in variants), key=lambda s: s.opinions)
        return size

    def _stack(self, root: str) -> list[str]:
        """Identifiers of a layer and its sublayers, each as often as it occurs."""
        if root not in self._stacks:
            found, waiting = [], [(root, 0)]
            while waiting:
                name, depth = waiting.pop()
                if depth > MAX_ARC_DEPTH:
                    continue  # a circle, or a sublayer that nobody needs
                found.append(name)
                if len(found) + len(waiting) > MAX_LAYERS:
                    raise _too_large(f"its sublayers multiply to more than {MAX_LAYERS:,}")
                layer = self._layers[name]
                for asset in layer.subLayerPaths:
                    sublayer = self._find(layer, asset)
                    if sublayer is not None:
                        self._layers[sublayer.identifier] = sublayer
                        waiting.append((sublayer.identifier, depth + 1))
            self._stacks[root] = found
        return self._stacks[root]

    def _outline(self, name: str) -> _Outline:
        if name not in self._outlines:
            self._outlines[name] = self._make_outline(self._layers[name])
        return self._outlines[name]

    def _make_outline(self, layer: Sdf.Layer) -> _Outline:
        outline, roots, place = _Outline(), [_ROOT], 0
        while roots:
            waiting: list[tuple[Sdf.Spec | None, Sdf.Path, int]] = [(layer.GetObjectAtPath(roots.pop()), _ROOT, 0)]
            while waiting:
                spec, path, first = waiting.pop()
                if spec is None:
                    outline.spans[path] = first, place
                    continue
                path, keys = spec.path, spec.ListInfoKeys()
                waiting.append((None, path, place))
                variants = tuple(_variants(layer, path)) if _VARIANTS in keys else ()
                targets = () if _ARCS.isdisjoint(keys) else tuple(self._targets(layer, spec, keys))
                if targets or variants:
                    is_instance = "instanceable" in keys and bool(spec.GetInfo("instanceable"))
                    outline.arcs.append((place, _Arcs(targets, variants, is_instance)))
                    roots += [variant for group in variants for variant in group]
                if "clips" in keys:
                    _check_clips(spec, path)
                place += 1
                holder = spec.primSpec if path.IsPrimVariantSelectionPath() else spec
                waiting += [(child, path, 0) for child in holder.nameChildren]
        return outline

    def _targets(self, layer: Sdf.Layer, spec: Sdf.Spec, keys: list[str]) -> Iterator[tuple[str | None, Sdf.Path]]:
        for key in _ARCS:
            for arc in spec.GetInfo(key).GetAddedOrExplicitItems() if key in keys else ():
                if isinstance(arc, Sdf.Path):
                    yield None, arc
                    continue
                found = self._find(layer, arc.assetPath) if arc.assetPath else None
                if arc.assetPath and found is None:
                    continue
                if found is not None:
                    self._layers[found.identifier] = found
                path = arc.primPath or _default_path(found or layer)
                if not path.isEmpty:
                    yield found.identifier if found is not None else None, path


def _default_path(layer: Sdf.Layer) -> Sdf.Path:
    return layer.GetDefaultPrimAsPath() if layer.defaultPrim else Sdf.Path.emptyPath


def _variants(layer: Sdf.Layer, path: Sdf.Path) -> Iterator[tuple[Sdf.Path, ...]]:
    prim = layer.GetPrimAtPath(path)
    for name, variant_set in prim.variantSets.items() if prim else ():
        found = tuple(path.AppendVariantSelection(name, variant.name) for variant in variant_set.variantList)
        if found:
            yield found


def _check_clips(spec: Sdf.Spec, path: Sdf.Path) -> None:
    """Raise `StageError` where the template of value clips names more files than anybody has."""
    for name, clips in dict(spec.GetInfo("clips")).items():
        start, end, stride = (clips.get(f"template{part}") for part in ("StartTime", "EndTime", "Stride"))
        if all(isinstance(value, float | int) for value in (start, end, stride)):
            count = (end - start) / stride if stride > 0 else 0
            if not count <= MAX_CLIPS:  # nor what is no number
                message = f"value clips '{name}' of {path} are {count:,.0f} files: expected up to {MAX_CLIPS:,}"
                raise StageError(message, code="too_many_clips", path=str(path))


def _too_large(why: str) -> StageError:
    return StageError(f"the stage is too large to be composed: {why}", code="too_many_prims")
