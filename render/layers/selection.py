"""Selection of the clusters that a pass draws: of a view's layers, and of a shadow map."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import moderngl
import numpy as np

from render.layers.clusters import ClusterIndex, DrawRange
from render.layers.hidden import HiddenMeasurer
from render.layers.index import Draw
from render.layers.targets import Slot
from render.model.arrays import DoubleArray, IndexArray
from render.optics.view import PinholeView

Choose = Callable[[PinholeView], IndexArray | None]
"""Function that gives the ascending indices of the clusters that a view may show; None for all."""
DrawnRanges = tuple[Draw, list[DrawRange]]
"""A draw, and the ranges of it that are drawn, in order."""


class Indexed(Protocol):
    """Draws and their clusters (`render.layers.index.SceneIndex`, or that of sketches)."""

    @property
    def draws(self) -> list[Draw]:
        """The draws; another list once they change."""
        ...

    @property
    def clusters(self) -> ClusterIndex:
        """Their clusters."""
        ...


@dataclass(frozen=True, eq=False)
class _Seen:
    """Clusters that a view may see.

    Attributes:
        view: the view.
        draws: the index's draws at that time.
        index: the index's clusters.
        clusters: their indices, ascending.
    """

    view: PinholeView
    draws: list[Draw]
    index: ClusterIndex
    clusters: IndexArray

    @cached_property
    def rectangles(self) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """As `ClusterIndex.rectangles`, of all of them."""
        return self.index.rectangles(self.clusters, self.view)


class ClusterSelection:
    """Selects clusters of a render index. The clusters of the last view are kept, since its layers are drawn one after another.

    Args:
        index: draws and their clusters.
        measurer: measures what layers hide.
        choose: gives the clusters that a view may show; None where it may show all.
    """

    def __init__(self, index: Indexed, measurer: HiddenMeasurer, choose: Choose | None = None) -> None:
        self._index, self._measurer, self._choose = index, measurer, choose
        self._seen: _Seen | None = None

    def draws_in(self, view: PinholeView) -> list[Draw]:
        """Draws that may reach into a view."""
        return [self._index.draws[i] for i in self._index.clusters.draws_of(self._see(view).clusters)]

    def clusters_in(self, view: PinholeView) -> IndexArray:
        """Indices of the clusters that may be seen in a view, ascending."""
        return self._see(view).clusters

    def ranges(
        self,
        view: PinholeView,
        draws: Sequence[Draw],
        previous: Slot | None,
        umbra: float,
        reach: moderngl.Texture | None = None,
    ) -> list[DrawnRanges]:
        """Ranges of draws that may leave fragments in a layer.

        Args:
            view: view of the layer.
            draws: draws that are considered.
            previous: slot of the layer before; None for the first.
            umbra: least reach of an opaque surface's umbra, 1/m.
            reach: bound on what rays meet behind that layer (`render.layers.reach`); None without.
        """
        seen = self._see(view)
        clusters = seen.clusters
        if previous is not None and len(clusters):
            clusters = clusters[~self._measurer.measure(previous, umbra, reach).hide(*seen.rectangles)]
        return self._of(clusters, draws)

    def shadow_ranges(self, clip_from_world: DoubleArray, draws: Sequence[Draw]) -> list[DrawnRanges]:
        """Ranges of draws that may leave fragments in a shadow map; both sides cast shadows."""
        return self._of(self._index.clusters.select(clip_from_world, draws), draws)

    def release(self) -> None:
        """Release the memory on the device."""
        self._measurer.release()
        self._seen = None

    def _see(self, view: PinholeView) -> _Seen:
        seen = self._seen
        if seen is None or seen.view is not view or seen.draws is not self._index.draws:
            clip_from_world = view.projection_matrix() @ view.camera_from_world
            eye = np.linalg.inv(view.camera_from_world) @ (view.eye_x_m, view.eye_y_m, 0.0, 1.0)
            among = None if self._choose is None else self._choose(view)
            clusters = self._index.clusters.select(clip_from_world, eye=eye[:3], among=among)
            seen = self._seen = _Seen(view, self._index.draws, self._index.clusters, clusters)
        return seen

    def _of(self, clusters: IndexArray, draws: Iterable[Draw]) -> list[DrawnRanges]:
        """Ranges that cover clusters, of each of the draws that has any."""
        ranges = {id(self._index.draws[i]): found for i, found in self._index.clusters.ranges(clusters).items()}
        return [(draw, ranges[id(draw)]) for draw in draws if id(draw) in ranges]
