"""Draws of sketches: those of the render index, and beside them the simpler levels of their meshes.

Each section of a mesh (`render.layers.levels.simplify`) is drawn at the coarsest level whose error is at most `MOST_ERROR_PX`
of the sketch's pixels at the section's least depth, each instance by itself. Levels are made in a background thread, of
geometries that two sketches in a row have drawn. Until they are ready, and for meshes that bend from frame to frame, sketches
draw the whole geometry. So they do where something may be transparent, since a merged surface may cover a pixel twice, and for
very many instances of a large mesh (more than `render.layers.clusters.MOST_CLUSTERS` in all). Shadow maps always hold the
whole geometry.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from render.layers.bounds import CLUSTER_TRIANGLES
from render.layers.clusters import MOST_CLUSTERS, ClusterIndex, in_frustum, nearest_depths
from render.layers.index import Draw, Nodes, SceneIndex
from render.layers.levels.maker import LevelMaker
from render.layers.levels.simplify import LEAST_TRIANGLES, Levels
from render.model.arrays import DoubleArray, IndexArray
from render.model.scene import Batch, Geometry
from render.optics.view import PinholeView

MOST_ERROR_PX = 0.5
"""Error of the level that is drawn, in pixels of the sketch's layers."""


@dataclass(frozen=True, eq=False)
class _Choice:
    """Errors of the clusters of all draws, and the sections that they belong to.

    Attributes:
        section: ``(n,)`` section of each cluster, of one instance.
        error_m: ``(n,)`` error of the cluster's level, in the world.
        coarser_m: ``(n,)`` error of the next level of its section; infinite where there is none.
        low: ``(s, 3)`` least corner of each section, metres.
        high: ``(s, 3)`` greatest corner.
    """

    section: IndexArray
    error_m: DoubleArray
    coarser_m: DoubleArray
    low: DoubleArray
    high: DoubleArray


class SketchIndex:
    """Draws of sketches. Their nodes are in the graph of the render index, where they are uploaded with it.

    Args:
        index: render index.

    Attributes:
        draws: draws of the whole geometries and of their levels.
        clusters: their clusters.
        maker: makes the levels.
        most_error_px: error of the levels that are drawn; 0 draws whole geometries.
    """

    def __init__(self, index: SceneIndex) -> None:
        self._index = index
        self.maker = LevelMaker()
        self.most_error_px = MOST_ERROR_PX
        self._nodes: Nodes = {}
        self._drawn: dict[int, Geometry] = {}
        self._levels: dict[int, Levels] = {}
        self._batches: dict[int, tuple[Batch, Batch]] = {}
        self._both = ClusterIndex()
        self._choice: _Choice | None = None
        self._draw_whole()

    def update(self) -> bool:
        """Follow the render index, and take up levels that have become ready. Called before each sketch.

        Returns:
            Whether the graph has nodes that must be uploaded.
        """
        drawn = {id(draw.batch.geometry): draw.batch.geometry for draw in self._index.draws if _has_levels(draw)}
        self.maker.want(geometry for key, geometry in drawn.items() if key in self._drawn)
        self._drawn = drawn
        levels = self.maker.made()
        if self._of is self._index.draws and self._levels.keys() == levels.keys():
            return False
        before, self._levels = self._nodes, levels
        if levels:
            self._draw_levels()
        else:
            self._index.remove_nodes(self._nodes, {})
            self._nodes = {}
            self._draw_whole()
        return self._nodes.keys() != before.keys()

    def drop(self) -> None:
        """Draw no levels until the next `update`, and take those out of the graph whose geometries the render index has lost."""
        drawn = {id(draw.batch.geometry) for draw in self._index.draws}
        self._levels = {key: levels for key, levels in self._levels.items() if key in drawn}
        made = {id(levels.geometry) for levels in self._levels.values()}
        kept = {key: node for key, node in self._nodes.items() if key[0] in made}
        self._index.remove_nodes(self._nodes, kept)
        self._nodes = kept
        if not kept:
            self._batches, self._both = {}, ClusterIndex()
        self._draw_whole()

    def choose(self, view: PinholeView) -> IndexArray | None:
        """Clusters of the levels that are drawn in a view, ascending; None where there are no levels.

        Args:
            view: view of the sketch's layers.
        """
        choice = self._choice
        if choice is None:
            return None
        allowed_m = self.most_error_px / max(view.fx, view.fy) * nearest_depths(choice.low, choice.high, view)
        allowed_m[~in_frustum(choice.low, choice.high, view.projection_matrix() @ view.camera_from_world)] = -1
        allowed = allowed_m[choice.section]
        return np.flatnonzero((choice.error_m <= allowed) & (allowed < choice.coarser_m))

    def release(self) -> None:
        """Stop making levels."""
        self.maker.release()

    def _draw_whole(self) -> None:
        """Draw what the render index draws."""
        self.draws, self.clusters, self._choice = self._index.draws, self._index.clusters, None
        self._of: list[Draw] | None = self._index.draws if not self._levels else None

    def _draw_levels(self) -> None:
        """Draw levels beside the geometries that they were made of."""
        kept: Nodes = {}
        batches: dict[int, tuple[Batch, Batch]] = {}
        draws, of = [], []
        for draw in self._index.draws:
            own = self._levels.get(id(draw.batch.geometry)) if _has_levels(draw) else None
            draws.append(draw)
            of.append(own)
            if own is None:
                continue
            self._both.hold(own.geometry, own.clusters)
            batch = draw.batch
            batches[id(batch)] = self._batches.get(id(batch)) or (batch, replace(batch, geometry=own.geometry))
            simple = batches[id(batch)][1]
            node = self._index.node(simple, draw.instances, draw.mirrored, self._nodes, kept)
            draws.append(replace(draw, node=node, batch=simple))
            of.append(own)
        self._index.remove_nodes(self._nodes, kept)
        self._both.update(draws, self._index.clusters)
        self._nodes, self._batches, self._of = kept, batches, self._index.draws
        self.draws, self.clusters, self._choice = draws, self._both, _choice(self._both, draws, of)


def _has_levels(draw: Draw) -> bool:
    """Whether sketches may draw levels of it."""
    triangles = len(draw.batch.geometry.triangles)
    few = -(-triangles // CLUSTER_TRIANGLES) * len(draw.instances) <= MOST_CLUSTERS
    return triangles >= LEAST_TRIANGLES and not draw.may_be_transparent and few


def _choice(clusters: ClusterIndex, draws: Sequence[Draw], of: Sequence[Levels | None]) -> _Choice:
    """Errors and sections of clusters; ``of`` has the levels of each draw, whole or not, None for those without."""
    owner, first, instance = clusters.members()
    ends = np.cumsum(np.bincount(owner, minlength=len(draws)))
    sections, errors, coarsers = [], [], []
    count, first_section = 0, 0
    for i, (draw, levels) in enumerate(zip(draws, of, strict=True)):
        own = slice(count, int(ends[i]))
        count = int(ends[i])
        if levels is None:
            sections.append(np.full(own.stop - own.start, first_section))
            errors.append(np.zeros(own.stop - own.start))
            coarsers.append(np.full(own.stop - own.start, np.inf))
            first_section += 1
            continue
        number = first[own] // CLUSTER_TRIANGLES
        scale = np.linalg.norm(draw.batch.poses[draw.instances][:, :3, :3], ord=2, axis=(1, 2))[instance[own]]
        per_instance = int(levels.full_section[-1]) + 1
        is_whole = draw.batch.geometry is not levels.geometry
        section = (levels.full_section if is_whole else levels.section)[number]
        sections.append(first_section + per_instance * instance[own] + section)
        errors.append(np.zeros(len(number)) if is_whole else levels.error_m[number] * scale)
        coarsers.append((levels.full_coarser_m if is_whole else levels.coarser_m)[number] * scale)
        if not is_whole:
            first_section += per_instance * len(draw.instances)
    section = np.concatenate(sections)
    low, high = clusters.boxes()
    least, greatest = np.full((first_section, 3), np.inf), np.full((first_section, 3), -np.inf)
    for axis in range(3):
        np.minimum.at(least[:, axis], section, low[:, axis])
        np.maximum.at(greatest[:, axis], section, high[:, axis])
    return _Choice(section, np.concatenate(errors), np.concatenate(coarsers), least, greatest)
