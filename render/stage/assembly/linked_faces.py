"""Faces of a mesh that the same lights leave out, by the geom subsets that the lights' collections name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pxr import Usd, UsdGeom

from render.stage.findings import FindingLog
from render.stage.materials.bindings import face_count, subset_faces

MAX_SUBSETS = 256
"""Groups of subsets of a mesh that are told apart."""
MAX_PATTERNS = 4096
"""Patterns (`LinkedFaces`) that the faces of a mesh may have."""

Groups = tuple[tuple[str, ...], ...]
"""Names of a mesh's subsets in groups, each of which counts as one subset."""


@dataclass(frozen=True)
class LinkedFaces:
    """Faces of a mesh, chosen by the subsets that hold them.

    Attributes:
        groups: the mesh's subsets that tell its faces apart.
        patterns: which of the groups hold a face, a bit for each, of all faces that are chosen.
    """

    groups: Groups
    patterns: frozenset[int]

    def held(self, mesh: Usd.Prim, count: int, time: Usd.TimeCode, log: FindingLog) -> NDArray[np.bool_]:
        """Whether each of the first ``count`` faces of a mesh is chosen, ``(count,)``.

        Args:
            mesh: the mesh.
            count: number of faces.
            time: when.
            log: notes subsets that cannot be used.
        """
        numbers, patterns = _tell_apart(mesh, self.groups, count, time, log)
        chosen = np.array([pattern in self.patterns for pattern in patterns], bool)
        return np.asarray(chosen[numbers])


def find_patterns(mesh: Usd.Prim, groups: Groups, log: FindingLog) -> set[int]:
    """Find every pattern (`LinkedFaces`) that a face of a mesh has at a time sample of the subsets.

    Args:
        mesh: the mesh.
        groups: its subsets.
        log: notes subsets that cannot be used.

    Raises:
        ValueError: there are more than `MAX_PATTERNS`.
    """
    times = {Usd.TimeCode.EarliestTime()}
    for name in (name for names in groups for name in names):
        times.update(map(Usd.TimeCode, _subset(mesh, name).GetIndicesAttr().GetTimeSamples()))
    times.update(map(Usd.TimeCode, UsdGeom.Mesh(mesh).GetFaceVertexCountsAttr().GetTimeSamples()))
    found: set[int] = set()
    for time in times:
        found.update(_tell_apart(mesh, groups, face_count(mesh, time), time, log)[1])
        _check_count(len(found))
    return found


def linked_faces_vary(mesh: Usd.Prim, faces: LinkedFaces | None) -> bool:
    """Whether the faces of a mesh that are chosen may change over time; None chooses all."""
    names = (name for group in (faces.groups if faces is not None else ()) for name in group)
    return any(_subset(mesh, name).GetIndicesAttr().ValueMightBeTimeVarying() for name in names)


def _subset(mesh: Usd.Prim, name: str) -> UsdGeom.Subset:
    return UsdGeom.Subset(mesh.GetStage().GetPrimAtPath(mesh.GetPath().AppendChild(name)))


def _tell_apart(
    mesh: Usd.Prim, groups: Groups, count: int, time: Usd.TimeCode, log: FindingLog
) -> tuple[NDArray[np.intp], list[int]]:
    """Number of each face's pattern, ``(count,)``, and the patterns.

    Each group in turn splits the faces of the patterns so far into those that it holds and others, so that time and memory
    grow with the faces, not with faces times groups.
    """
    numbers = np.zeros(count, np.intp)
    patterns, sizes = ([0] if count else []), np.array([count] if count else [], np.intp)
    authored = face_count(mesh, time)
    for bit, names in enumerate(groups):
        faces = _held_faces(mesh, names, count, authored, time, log)
        inside = np.bincount(numbers[faces], minlength=len(sizes))
        is_split = (inside > 0) & (inside < sizes)
        renumbered = np.arange(len(sizes))
        renumbered[is_split] = len(sizes) + np.arange(is_split.sum())
        numbers[faces] = renumbered[numbers[faces]]
        split = [patterns[i] | 1 << bit for i in np.flatnonzero(is_split)]
        for i in np.flatnonzero((inside > 0) & ~is_split):
            patterns[i] |= 1 << bit
        patterns += split
        sizes = np.concatenate([np.where(is_split, sizes - inside, sizes), inside[is_split]])
        _check_count(len(patterns))
    return numbers, patterns


def _held_faces(
    mesh: Usd.Prim, names: Sequence[str], count: int, authored: int, time: Usd.TimeCode, log: FindingLog
) -> NDArray[np.intp]:
    """Faces, of the first ``count``, that any of some subsets holds, each once."""
    is_held = np.zeros(count, bool)
    for name in names:
        faces = subset_faces(_subset(mesh, name), authored, time, log)
        is_held[faces[(faces >= 0) & (faces < count)]] = True
    return np.flatnonzero(is_held)


def _check_count(count: int) -> None:
    if count > MAX_PATTERNS:
        raise ValueError(f"its subsets overlap in more than {MAX_PATTERNS} ways")
