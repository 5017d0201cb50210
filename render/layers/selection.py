"""Selection of the clusters that a pass draws: of a view's layers, and of a shadow map."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol, Self

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


def seen_draws(draws: list[Draw]) -> list[Draw]:
    """Draws that a camera sees; the same list where it sees all."""
    seen = [draw for draw in draws if draw.batch.camera_role != "unseen"]
    return draws if len(seen) == len(draws) else seen


class DrawnRanges(NamedTuple):
    """Part of a draw that is drawn.

    Attributes:
        draw: the draw.
        ranges: its ranges, in order.
        shows_backs: whether back faces are drawn.
    """

    draw: Draw
    ranges: list[DrawRange]
    shows_backs: bool


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
        both_sides: indices of the draws whose back faces the view may see.
    """

    view: PinholeView
    draws: list[Draw]
    index: ClusterIndex
    clusters: IndexArray
    both_sides: frozenset[int]

    @cached_property
    def rectangles(self) -> tuple[DoubleArray, DoubleArray, DoubleArray]:
        """As `ClusterIndex.rectangles`, of all of them."""
        return self.index.rectangles(self.clusters, self.view)


@dataclass(frozen=True, eq=False)
class _Insides:
    """Boxes of all closed surfaces (`Draw.insides`).

    Attributes:
        draws: draws that they are of.
        boxes: ``(n, 2, 3)`` least and greatest corners, metres.
        owner: ``(n,)`` index of the draw of each.
    """

    draws: list[Draw]
    boxes: DoubleArray
    owner: IndexArray

    @classmethod
    def of(cls, draws: list[Draw]) -> Self:
        """Collect those of draws."""
        found = [(i, draw.insides) for i, draw in enumerate(draws) if draw.insides is not None]
        boxes = [insides for _, insides in found]
        owner = np.repeat([i for i, _ in found], [len(insides) for insides in boxes]).astype(np.intp)
        return cls(draws, np.concatenate([np.zeros((0, 2, 3)), *boxes]), owner)


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
        self._insides: _Insides | None = None

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
        return self._of(clusters, draws, seen.both_sides)

    def shadow_ranges(self, clip_from_world: DoubleArray, draws: Sequence[Draw]) -> list[DrawnRanges]:
        """Ranges of draws that may leave fragments in a shadow map; both sides cast shadows."""
        return self._of(self._index.clusters.select(clip_from_world, draws), draws, range(len(self._index.draws)))

    def release(self) -> None:
        """Release the memory on the device."""
        self._measurer.release()
        self._seen = self._insides = None

    def _see(self, view: PinholeView) -> _Seen:
        seen = self._seen
        if seen is None or seen.view is not view or seen.draws is not self._index.draws:
            clip_from_world = view.projection_matrix() @ view.camera_from_world
            among = None if self._choose is None else self._choose(view)
            both_sides = self._seen_from_inside(view)
            index = self._index.clusters
            clusters = index.select(
                clip_from_world,
                seen_draws(self._index.draws),
                eye=view.eye_in_world,
                among=among,
                both_sides=both_sides,
            )
            seen = self._seen = _Seen(view, self._index.draws, index, clusters, both_sides)
        return seen

    def _seen_from_inside(self, view: PinholeView) -> frozenset[int]:
        """Indices of the draws of closed surfaces whose insides a view may show: the near plane or a clip plane may cut them."""
        draws = self._index.draws
        if self._insides is None or self._insides.draws is not draws:
            self._insides = _Insides.of(draws)
        own = self._insides
        if view.clip_planes:
            return frozenset(own.owner.tolist())
        away = np.maximum(np.maximum(own.boxes[:, 0] - view.eye_in_world, view.eye_in_world - own.boxes[:, 1]), 0.0)
        return frozenset(own.owner[np.sum(away**2, axis=1) <= view.farthest_near_m**2].tolist())

    def _of(self, clusters: IndexArray, draws: Iterable[Draw], both_sides: Container[int]) -> list[DrawnRanges]:
        """Ranges that cover clusters, of each of the draws that has any; ``both_sides`` as in `_Seen`."""
        numbers = {id(draw): i for i, draw in enumerate(self._index.draws)}
        ranges = self._index.clusters.ranges(clusters)
        return [
            DrawnRanges(draw, ranges[i], draw.has_backs or i in both_sides)
            for draw in draws
            if (i := numbers.get(id(draw))) in ranges
        ]
