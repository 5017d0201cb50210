"""Choice of levels of detail for a camera (UsdLod): an override, else a heuristic, else the default level.

USD computes overrides and heuristics itself, in scene units. A heuristic may give a mix of two levels; the nearer one is drawn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Usd, UsdGeom, UsdLod, Vt

from render.model.arrays import DoubleArray, IntArray
from render.stage.assembly.inventory import LevelRoot, Levels, Occurrence
from render.stage.assembly.level_heuristics import HeuristicError, compute_levels, find_faults, make_query
from render.stage.assembly.poses import InstanceReader, instance_poses, world_pose
from render.stage.findings import FindingLog
from render.stage.limits import PlaceError
from render.stage.values import format_value

_ALL, _NONE = -1, -2
_FRUSTUM = {
    "clippingRange",
    "focalLength",
    "horizontalAperture",
    "horizontalApertureOffset",
    "projection",
    "verticalAperture",
    "verticalApertureOffset",
}
"""Properties of cameras by which their frustum is computed."""
_MODES = ("noOverride", "indexedLOD", "noLOD", "allLOD")


@dataclass(frozen=True, eq=False)
class LevelChoice:
    """Levels of detail that are drawn.

    Attributes:
        chosen: level by root, ``(k,)`` for its instances, in the order of `instance_poses`; or one of two marks for all and none.
    """

    chosen: dict[LevelRoot, IntArray] = field(default_factory=dict)

    def equals(self, other: LevelChoice) -> bool:
        """Whether the same levels are drawn."""
        return self.chosen.keys() == other.chosen.keys() and all(
            np.array_equal(one, other.chosen[root]) for root, one in self.chosen.items()
        )

    def may_show(self, surface: Occurrence) -> bool:
        """Whether a surface is drawn, as far as that is known without its instances."""
        return bool(surface.chain) or bool(self.shows(surface.levels).all())

    def shows(self, levels: Levels, count: int = 1) -> NDArray[np.bool_]:
        """``(count,)`` which instances of what is in some levels are drawn.

        Args:
            levels: of a surface or a light.
            count: number of its instances.
        """
        shown = np.ones(count, bool)
        for root, level in levels:
            chosen = self.chosen[root]
            if count:
                shown &= np.repeat((chosen == level) | (chosen == _ALL), count // len(chosen))
        return shown


def may_change_levels(path: Sdf.Path) -> bool:
    """Whether an edit of a camera may change which levels it shows: of its place or frustum, or of the prim as a whole."""
    return not path.IsPropertyPath() or path.name in _FRUSTUM or path.name.startswith("xformOp")


class LevelChooser:
    """Chooses levels of detail.

    Args:
        stage: the stage.
        roots: prims whose children are levels.
        log: receives heuristics and overrides that cannot be used.
    """

    def __init__(self, stage: Usd.Stage, roots: Sequence[LevelRoot], log: FindingLog) -> None:
        self._stage, self._roots, self._log = stage, roots, log

    def choose(self, camera_path: str, transforms: UsdGeom.XformCache, instances: InstanceReader) -> LevelChoice:
        """Choose the levels that a camera shows.

        Args:
            camera_path: prim path of the camera; empty for none, which leaves heuristics out.
            transforms: transforms at the time.
            instances: reads instancers, at the same time.
        """
        if not self._roots:
            return LevelChoice()
        camera = UsdGeom.Camera(self._stage.GetPrimAtPath(camera_path)) if camera_path else None
        heuristics = _Heuristics(self._stage, camera, transforms.GetTime(), self._log)
        chosen = {}
        for root in self._roots:
            try:
                places = _places(root, transforms, instances)
            except PlaceError:
                places = np.zeros((0, 4, 4))  # what stands there is named, and not drawn
            chosen[root] = self._choose(root, places, heuristics, transforms.GetTime())
        return LevelChoice(chosen)

    def _choose(self, root: LevelRoot, places: DoubleArray, heuristics: _Heuristics, time: Usd.TimeCode) -> IntArray:
        mode, index = UsdLod.OverrideAPI(root.prim).ComputeLODOverride(time)
        if mode not in _MODES:
            expected = f"lod:override:mode above {root.prim.GetPath()} must be inherited, {', '.join(_MODES)}"
            self._note(root, f"{expected}, got {format_value(mode)}: it is left out")
        if mode in ("allLOD", "noLOD"):
            return np.full(max(1, len(places)), _ALL if mode == "allLOD" else _NONE, np.int32)
        if mode == "indexedLOD" and math.isfinite(index):
            return np.full(max(1, len(places)), _nearest(index, root.count), np.int32)
        fallback = np.full(max(1, len(places)), self._default(root, time), np.int32)
        levels = heuristics.levels(root, places) if len(places) else None
        return fallback if levels is None else levels

    def _default(self, root: LevelRoot, time: Usd.TimeCode) -> int:
        index = UsdLod.RootAPI(root.prim).GetLodDefaultIndexAttr().Get(time)
        if isinstance(index, int) and 0 <= index < root.count:
            return index
        level = _nearest(index, root.count) if isinstance(index, int) else 0
        expected = f"lod:default:index of {root.prim.GetPath()} must be from 0 to {root.count - 1}"
        self._note(root, f"{expected}, got {format_value(index)}: {level} is used")
        return level

    def _note(self, root: LevelRoot, message: str) -> None:
        self._log.add("level_of_detail", root.prim.GetPath(), message)


class _Heuristics:
    """Heuristics as they are for one camera at one time, each read once."""

    def __init__(self, stage: Usd.Stage, camera: UsdGeom.Camera | None, time: Usd.TimeCode, log: FindingLog) -> None:
        self._stage, self._time, self._log = stage, time, log
        self._seen = (camera.GetCamera(time), camera.GetPath()) if camera else None
        self._read: dict[Sdf.Path, UsdLod.HeuristicQuery | None] = {}

    def levels(self, root: LevelRoot, places: DoubleArray) -> IntArray | None:
        """Levels ``(k,)`` of a root at some places, by the first heuristic that can be used; None where none can.

        Args:
            root: the root.
            places: ``(k, 4, 4)`` stage from the root's own space.
        """
        if self._seen is None:
            return None
        camera, camera_path = self._seen
        matrices = list(Vt.Matrix4dArray.FromNumpy(np.ascontiguousarray(places.transpose(0, 2, 1))))
        for path in UsdLod.RootAPI(root.prim).GetLodHeuristicsRel().GetForwardedTargets():
            query = self._query(path)
            if query is None:
                continue
            try:
                found = compute_levels(query, camera, matrices)
            except HeuristicError as problem:
                self._note(path, f"is not used for {camera_path}: {problem}")
                continue
            return np.clip(np.floor(found + 0.5), 0, root.count - 1).astype(np.int32)
        return None

    def _query(self, path: Sdf.Path) -> UsdLod.HeuristicQuery | None:
        """The heuristic as USD computes it; None where it cannot be used, or is for others than pictures."""
        if path not in self._read:
            try:
                self._read[path] = query = make_query(self._stage.GetPrimAtPath(path), self._time)
                for fault in find_faults(self._stage.GetPrimAtPath(path), query, self._time) if query else ():
                    self._note(path, f"is used in part: {fault}")
            except HeuristicError as problem:
                self._read[path] = None
                self._note(path, f"is not used: {problem}")
        return self._read[path]

    def _note(self, path: Sdf.Path, message: str) -> None:
        self._log.add("level_of_detail", path, f"heuristic {path} of levels of detail {message}")


def _nearest(level: float, count: int) -> int:
    """The nearest level that there is."""
    return int(min(max(math.floor(level + 0.5), 0), count - 1))


def _places(root: LevelRoot, transforms: UsdGeom.XformCache, instances: InstanceReader) -> DoubleArray:
    """``(k, 4, 4)`` stage from the root's own space.

    Raises:
        PlaceError: a transform is not finite.
    """
    if root.chain:
        return instance_poses(root.chain, root.prim, transforms, np.eye(4), instances)[0]
    return world_pose(root.prim, transforms, np.eye(4))[None]
