"""Places on displaced surfaces: those of the triangles that are drawn, but for a level of refinement that no camera chooses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray
from render.model.face_places import barycentric, place_in_fan
from render.stage.assembly.subdivision_levels import LEVELS
from render.stage.findings import FindingLog
from render.stage.geometry.displacement import metric_of
from render.stage.geometry.polygons import Polygons
from render.stage.geometry.primvars import find_primvar
from render.stage.geometry.reading import ShapeSource, read_displaced
from render.stage.geometry.shape import PrimvarNames
from render.stage.geometry.skinning import Skeletons
from render.stage.geometry.subdivision.reading import scheme_of
from render.stage.geometry.subdivision.refinement import fitting_level
from render.stage.geometry.surface import mesh_faces, surface_varies
from render.stage.materials.bindings import BoundPart, binding_purposes, bound_parts, face_owner
from render.stage.materials.looks import LookReader
from render.stage.materials.textures import TextureCache
from render.stage.opening import confinement

_MOST_TEXELS = 2048
_AUTO_LEVEL = 6
_MOST_TRIANGLES = 100_000
"""Triangles of an automatically refined surface on which places are found."""


class DisplacedPlaces:
    """Places on the displaced surfaces of a stage.

    Args:
        stage: the stage.
        skeletons: bend meshes.
        log: for findings.
        complexity: of the surfaces (`render.stage.options.StageOptions`).
    """

    def __init__(self, stage: Usd.Stage, skeletons: Skeletons, log: FindingLog, complexity: str) -> None:
        self._stage, self._skeletons, self._log = stage, skeletons, log
        self._complexity = complexity
        self._known: dict[tuple[str, str], _Displaced] = {}

    def find(self, prim: Usd.Prim, face: int, fan: int, weights: DoubleArray, time: Usd.TimeCode) -> DoubleArray | None:
        """``(3,)`` a place in a prim's own space and units; None where its material does not displace it.

        Args:
            prim: a drawable prim.
            face: of its authored or generated faces.
            fan: triangle of the face's fan.
            weights: ``(3,)`` barycentric coordinates there.
            time: when.
        """
        material = self._material(prim, face, time)
        displacement = self._looks.displacement(material, time) if material else None
        if displacement is None:
            return None
        key = str(prim.GetPath()), material
        known = self._known.get(key)
        if known is None or (known.varies and known.time != time):
            source = ShapeSource(
                prim,
                PrimvarNames(uv=None),
                judged=False,
                seams=False,
                level=self._level(prim, time),
                displacement=displacement,
                metric=metric_of(prim),
            )
            primvar = find_primvar(prim, displacement.primvar) if displacement.primvar else None
            varies = surface_varies(prim, self._skeletons) or displacement.varies
            varies = varies or (primvar is not None and primvar.varies())
            polygons = read_displaced(source, time, self._skeletons, self._log)
            known = self._known[key] = _Displaced(time, varies, polygons)
        return known.place(face, fan, weights)

    @cached_property
    def _looks(self) -> LookReader:
        textures = TextureCache(_MOST_TEXELS, confined_to=confinement(self._stage))
        return LookReader(self._stage, textures, self._log)

    @cached_property
    def _purposes(self) -> tuple[str, ...]:
        return binding_purposes(self._stage, self._log)

    def _material(self, prim: Usd.Prim, face: int, time: Usd.TimeCode) -> str:
        parts: list[BoundPart] = bound_parts(prim, self._purposes, time, self._log)
        return parts[int(face_owner(parts, face + 1)[face])].material

    def _level(self, prim: Usd.Prim, time: Usd.TimeCode) -> int:
        if scheme_of(prim) == "none":
            return 0
        level = LEVELS.get(self._complexity)
        corners = len(mesh_faces(prim, time)[1])
        return fitting_level(corners, _AUTO_LEVEL, _MOST_TRIANGLES) if level is None else fitting_level(corners, level)


@dataclass(frozen=True, eq=False)
class _Displaced:
    """Displaced surface.

    Attributes:
        time: at which it was read.
        varies: whether it may change over time.
        polygons: the surface.
    """

    time: Usd.TimeCode
    varies: bool
    polygons: Polygons | None

    def place(self, face: int, fan: int, weights: DoubleArray) -> DoubleArray | None:
        """``(3,)`` a place on an authored face; None where the surface could not be read."""
        if self.polygons is None:
            return None
        points, corners, counts = self.polygons.points.astype(np.float64), self.polygons.corners, self.polygons.counts
        starts = np.cumsum(counts, dtype=np.int64) - counts
        authored = self.polygons.authored
        if authored is None:
            return np.asarray(weights @ points[corners[starts[face] + np.array([0, fan + 1, fan + 2])]])
        here = np.flatnonzero(authored.faces == face)
        size = int(counts[here[0]])
        fans = np.stack([np.zeros(size - 2, np.intp), np.arange(1, size - 1), np.arange(2, size)], axis=1)
        triangles = (starts[here][:, None, None] + fans).reshape(-1, 3)
        place = place_in_fan(fan, weights, int(authored.sizes[here[0]]))
        inside = barycentric(authored.places[triangles].astype(np.float64), place)
        found = int(inside.min(axis=1).argmax())
        shares = np.maximum(inside[found], 0.0)
        return np.asarray(shares / shares.sum() @ points[corners[triangles[found]]])
