"""Choice of how finely subdivision surfaces are refined: as the user says, or by their size on screen."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.model.arrays import DoubleArray, IntArray
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.poses import InstanceReader, instance_poses, world_pose
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import BadGeometry, Polygons, check, unit
from render.stage.geometry.subdivision.reading import is_refined, read_cage
from render.stage.geometry.subdivision.refinement import (
    MOST_TRIANGLES,
    control_topology,
    fitting_level,
    triangles_at,
)
from render.stage.geometry.subdivision.rules import point_rules, sum_rows
from render.stage.geometry.subdivision.topology import Topology
from render.stage.geometry.surface import mesh_faces, resting_points
from render.stage.limits import PlaceError
from render.stage.values import UNREADABLE, why_unreadable

LEVELS = {"low": 0, "medium": 1, "high": 2, "veryhigh": 3}
"""Steps of refinement by complexity, as in usdrecord."""
SCREEN_PX = 1920
"""Width of the picture for whose pixels automatic levels are chosen: pictures of all sizes show the same surface."""
DISPLACED_PX = 2.0
"""Length of the edges of displaced surfaces at automatic levels."""
_MOST_AUTO_LEVEL = 5
_MOST_DISPLACED_LEVEL = 8
_MOST_AUTO_TRIANGLES = 400_000
MOST_IN_ALL, MOST_IN_ALL_AUTO = 20_000_000, 4_000_000
"""Triangles of all refined surfaces together, and of those that are refined automatically."""
_BENT_SHARE = 0.99
"""Share of a control mesh's edges that bend no more than what its level is chosen for."""
_MOST_SAMPLES = 100  # in which the first faces are looked for
_LEAST_DISTANCE = 0.1
"""Least distance from a surface, in radii of its sphere, that levels are chosen for."""

Levels = Mapping[Sdf.Path, int]
"""Steps of refinement by the path that surfaces are read from (`Occurrence.source`); 0 where a path is missing."""


@dataclass(frozen=True, eq=False)
class _ControlMesh:
    """Facts of a control mesh, in its own space and units.

    Attributes:
        places: places in which it stands.
        corners: number of its faces' corners.
        bend: distance of neighbours from the planes of points; `_BENT_SHARE` of all are no farther. Of automatic levels alone.
        edge: length of edges; 99 of 100 are no longer. Of displaced surfaces at automatic levels, else 0.
        centre: ``(3,)`` of its sphere.
        radius: of its sphere.
    """

    places: tuple[Occurrence, ...]
    corners: int
    bend: float
    edge: float
    centre: DoubleArray
    radius: float


class SubdivisionChooser:
    """Chooses the levels of a stage's subdivision surfaces.

    The edges of a surface that is refined in n steps are about ``bend / 4ⁿ⁺¹`` away from it: automatic levels keep that below a
    quarter of a pixel, at the least distance of the surface from the camera.

    Args:
        surfaces: all surfaces of the stage.
        complexity: one of `render.stage.options.COMPLEXITIES`.
        log: notes surfaces that are refined less than was wanted.
        displaced: paths of the sources of surfaces that are displaced, whose edges automatic levels keep below `DISPLACED_PX`,
            too; of bilinear ones as well.
    """

    def __init__(
        self,
        surfaces: Sequence[Occurrence],
        complexity: str,
        log: FindingLog,
        displaced: Collection[Sdf.Path] = frozenset(),
    ) -> None:
        self._level = LEVELS.get(complexity)
        self._log = log
        by_source: dict[Sdf.Path, list[Occurrence]] = defaultdict(list)
        for surface in surfaces:
            wanted = "high" if complexity == "auto" and surface.source in displaced else complexity
            if not surface.draw_mode and is_refined(surface.prim, wanted):
                by_source[surface.source].append(surface)
        is_auto = self._level is None
        found = (
            (source, _describe(tuple(places), log, is_auto=is_auto, is_displaced=source in displaced))
            for source, places in by_source.items()
        )
        self._meshes = {source: mesh for source, mesh in found if mesh is not None}

    @property
    def follows_camera(self) -> bool:
        """Whether levels depend on the camera."""
        return self._level is None and bool(self._meshes)

    def choose(
        self,
        camera: UsdGeom.Camera | None,
        transforms: UsdGeom.XformCache,
        instances: InstanceReader,
        world: DoubleArray,
    ) -> Levels:
        """Choose levels at a time.

        Args:
            camera: the camera; None for none, which takes the picture for as wide as all surfaces together.
            transforms: transforms at the time.
            instances: reads instancers, at the same time.
            world: world from stage.
        """
        if not self._meshes:
            return {}
        if self._level is not None:
            fitting = {source: fitting_level(mesh.corners, self._level) for source, mesh in self._meshes.items()}
            for source, level in fitting.items():
                if level < self._level:
                    self._note_size(source, level)
            return self._fit(fitting, MOST_IN_ALL)
        spheres = {source: _spheres(mesh, transforms, instances, world) for source, mesh in self._meshes.items()}
        standing = {source: found for source, found in spheres.items() if found is not None}
        if not standing:
            return {}
        eye = _eye_of(camera, transforms, world) if camera is not None else _eye_of_all(list(standing.values()))
        levels: dict[Sdf.Path, int] = {}
        for source, found in standing.items():
            mesh = self._meshes[source]
            bend, edge = (
                eye.pixels(found.scale * each, found.centres, found.radius_m) for each in (mesh.bend, mesh.edge)
            )
            levels[source] = max(_auto_level(mesh, bend), _displaced_level(mesh, edge) if mesh.edge else 0)
        return self._fit(levels, MOST_IN_ALL_AUTO)

    def _fit(self, levels: Levels, most_triangles: int) -> Levels:
        """Levels at which all surfaces together have at most so many triangles; a finding where they are lower than given."""
        wanted = count = self._count(levels)
        while count > most_triangles and any(levels.values()):
            levels = {source: max(0, level - 1) for source, level in levels.items()}
            count = self._count(levels)
        if count < wanted:
            message = (
                f"subdivision surfaces are refined less than is wanted, to {count:,} triangles in place of {wanted:,}"
            )
            self._log.add("subdivision", "/", message)
        return levels

    def _count(self, levels: Levels) -> int:
        """Triangles of all refined surfaces."""
        refined = ((self._meshes[source], level) for source, level in levels.items() if level > 0)
        return sum(len(mesh.places) * triangles_at(mesh.corners, level) for mesh, level in refined)

    def _note_size(self, source: Sdf.Path, level: int) -> None:
        wanted = self._level or 0
        count = triangles_at(self._meshes[source].corners, wanted)
        message = f"{source} is refined in {level} steps, not {wanted}: it would have {count:,} triangles"
        self._log.add("subdivision", source, f"{message}, and up to {MOST_TRIANGLES:,} are drawn")


class _Eye:
    """Pixels that lengths have in a picture.

    Args:
        position: ``(3,)`` of the camera, metres in the world; None where distance does not matter.
        scale: pixels of a metre, at one metre from the camera where distance matters.
    """

    def __init__(self, position: DoubleArray | None, scale: float) -> None:
        self._position, self._scale = position, scale

    def pixels(self, length_m: DoubleArray, centres: DoubleArray, radius_m: DoubleArray) -> float:
        """Most pixels of lengths ``(n,)`` in spheres, where these are nearest."""
        if self._position is None:
            return float((self._scale * length_m).max())
        distance_m = np.linalg.norm(centres - self._position, axis=1) - radius_m
        distance_m = np.maximum(np.maximum(distance_m, _LEAST_DISTANCE * radius_m), 1e-30)
        return float((self._scale * length_m / distance_m).max())


def _eye_of(camera: UsdGeom.Camera, transforms: UsdGeom.XformCache, world: DoubleArray) -> _Eye:
    time = transforms.GetTime()
    pose = world_pose(camera.GetPrim(), transforms, world)
    aperture = float(camera.GetHorizontalApertureAttr().Get(time) or 0.0)
    if not aperture > 0:
        return _Eye(None, 0.0)
    if camera.GetProjectionAttr().Get(time) == UsdGeom.Tokens.orthographic:
        width_m = aperture / 10 * float(np.linalg.norm(pose[:3, 0]))  # in tenths of a unit
        return _Eye(None, SCREEN_PX / width_m if width_m > 0 else 0.0)
    return _Eye(pose[:3, 3], SCREEN_PX * float(camera.GetFocalLengthAttr().Get(time) or 0.0) / aperture)


def _eye_of_all(spheres: Sequence[_Spheres]) -> _Eye:
    """Eye whose picture is as wide as all surfaces."""
    low = np.min([(each.centres - each.radius_m[:, None]).min(axis=0) for each in spheres], axis=0)
    high = np.max([(each.centres + each.radius_m[:, None]).max(axis=0) for each in spheres], axis=0)
    return _Eye(None, SCREEN_PX / max(float(np.linalg.norm(high - low)), 1e-30))


@dataclass(frozen=True, eq=False)
class _Spheres:
    """Spheres around the places of a control mesh.

    Attributes:
        centres: ``(n, 3)`` metres in the world.
        radius_m: ``(n,)``.
        scale: ``(n,)`` metres of a unit.
    """

    centres: DoubleArray
    radius_m: DoubleArray
    scale: DoubleArray


def _describe(
    places: tuple[Occurrence, ...], log: FindingLog, *, is_auto: bool, is_displaced: bool
) -> _ControlMesh | None:
    """Facts of a control mesh at the earliest time at which it has faces; None where it cannot be drawn, or is so large that
    automatic refinement leaves it alone.
    """
    prim = places[0].prim
    try:
        time, counts, corners = _first_faces(prim)
        if not len(corners) or (is_auto and not fitting_level(len(corners), 1, _MOST_AUTO_TRIANGLES)):
            return None
        polygons = Polygons(np.array(resting_points(prim, time), np.float32), counts, corners)
        check(polygons)
    except BadGeometry:
        return None  # it is named where it is read
    if not is_auto:
        return _ControlMesh(places, len(corners), 0.0, 0.0, np.zeros(3), 0.0)
    try:
        _, topology = control_topology(read_cage(prim, time), polygons)
    except UNREADABLE as problem:
        path = prim.GetPath()
        log.add("subdivision", path, f"{path} is drawn as its control mesh: {why_unreadable(problem)}")
        return None
    points = polygons.points.astype(np.float64)
    low, high = points[corners].min(axis=0), points[corners].max(axis=0)
    radius = float(np.linalg.norm(high - low)) / 2
    edge = _edge(topology, points) if is_displaced else 0.0
    return _ControlMesh(places, len(corners), _bend(topology, points), edge, (low + high) / 2, radius)


def _first_faces(prim: Usd.Prim) -> tuple[Usd.TimeCode, IntArray, IntArray]:
    """Earliest time at which a mesh has faces, their counts and their corners. Raises `BadGeometry` where they contradict."""
    samples = UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().GetTimeSamples()[:_MOST_SAMPLES]
    times = [Usd.TimeCode.EarliestTime(), *map(Usd.TimeCode, samples)]
    for time in times:
        counts, corners = mesh_faces(prim, time)
        if len(corners):
            return time, counts, corners
    return times[0], counts, corners


def _bend(topology: Topology, points: DoubleArray) -> float:
    """Distance of neighbours from the planes of points, of all but the most bent; along creases, of points from the line."""
    if not len(topology.edges):
        return 0.0
    here, after, before = (points[topology.corners[topology.beside(step)]] for step in (0, 1, -1))
    normals = unit(
        sum_rows(topology.corners, np.cross(after - here, before - here), topology.points).astype(np.float32)
    )
    along = points[topology.edges[:, 1]] - points[topology.edges[:, 0]]
    apart = [np.abs(np.einsum("ex,ex->e", along, normals[topology.edges[:, side]])) for side in range(2)]
    rules = point_rules(topology)
    on_crease = points[rules.along].mean(axis=1) - points[rules.creased]
    bends = np.concatenate([*apart, np.linalg.norm(on_crease, axis=1)])
    return _most_of(bends)


def _edge(topology: Topology, points: DoubleArray) -> float:
    """Length of edges, but for the longest."""
    if not len(topology.edges):
        return 0.0
    return _most_of(np.linalg.norm(points[topology.edges[:, 1]] - points[topology.edges[:, 0]], axis=1))


def _most_of(values: DoubleArray) -> float:
    """Value that `_BENT_SHARE` of all do not exceed; np.quantile would load numpy.ma at each start."""
    rank = int(_BENT_SHARE * (len(values) - 1))
    return float(np.partition(values, rank)[rank])


def _spheres(
    mesh: _ControlMesh, transforms: UsdGeom.XformCache, instances: InstanceReader, world: DoubleArray
) -> _Spheres | None:
    """Spheres around all places of a control mesh; None where it stands nowhere."""
    poses = []
    for place in mesh.places:
        with suppress(PlaceError):  # it is named, and not drawn
            if place.chain:
                poses.append(instance_poses(place.chain, place.prim, transforms, world, instances)[0])
            else:
                poses.append(world_pose(place.prim, transforms, world)[None])
    found = np.concatenate([np.zeros((0, 4, 4)), *poses])
    if not len(found):
        return None
    scale = np.linalg.norm(found[:, :3, :3], axis=1).max(axis=1)
    return _Spheres(found[:, :3, :3] @ mesh.centre + found[:, :3, 3], scale * mesh.radius, scale)


def _auto_level(mesh: _ControlMesh, bend_px: float) -> int:
    """Steps that keep edges within a quarter of a pixel of the surface, as far as the limits allow."""
    level = int(np.clip(np.ceil(np.log(max(bend_px, 1e-30)) / np.log(4)), 0, _MOST_AUTO_LEVEL))
    return fitting_level(mesh.corners, level, _MOST_AUTO_TRIANGLES)


def _displaced_level(mesh: _ControlMesh, edge_px: float) -> int:
    """Steps that keep edges below `DISPLACED_PX`, as far as the limits allow."""
    level = int(np.clip(np.ceil(np.log2(max(edge_px / DISPLACED_PX, 1e-30))), 0, _MOST_DISPLACED_LEVEL))
    return fitting_level(mesh.corners, level, _MOST_AUTO_TRIANGLES)
