"""Clouds of Gaussian splats of a stage, with their places."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from pxr import Usd

from render.model.arrays import DoubleArray, IntArray
from render.model.splats import MAX_SPLATS, SplatBatch, SplatCloud
from render.stage.assembly.groups import DrawContext, note_problem, places_of, shrink
from render.stage.assembly.inventory import Occurrence
from render.stage.assembly.poses import is_hidden
from render.stage.geometry.polygons import BadGeometry
from render.stage.geometry.splats import read_splats, splats_vary
from render.stage.limits import PlaceError


class SplatReader:
    """Reads the splats of a stage. What does not change between two times is the same object in both.

    Args:
        occurrences: clouds that are drawn.
    """

    def __init__(self, occurrences: Sequence[Occurrence]) -> None:
        self._occurrences = occurrences
        self._clouds: dict[str, tuple[Usd.TimeCode | None, SplatCloud | None]] = {}
        self._batches: dict[int, SplatBatch] = {}
        self._last: tuple[SplatBatch, ...] = ()

    def batches(self, context: DrawContext) -> tuple[SplatBatch, ...]:
        """Clouds that are drawn at a time, with their places, up to `MAX_SPLATS` splats; a finding for those beyond."""
        drawn, total = [], 0
        for number, occurrence in enumerate(self._occurrences):
            batch = self._batch(number, occurrence, context)
            if batch is None or not len(batch.poses):
                continue
            if total + batch.count > MAX_SPLATS:
                path = occurrence.path
                message = f"{path} is not drawn: it has {batch.count:,} splats, and a picture has up to {MAX_SPLATS:,}"
                context.log.add("too_many_splats", path, message)
                continue
            total += batch.count
            drawn.append(batch)
        if len(drawn) != len(self._last) or any(one is not other for one, other in zip(drawn, self._last, strict=True)):
            self._last = tuple(drawn)
        return self._last

    def _batch(self, number: int, occurrence: Occurrence, context: DrawContext) -> SplatBatch | None:
        """One cloud; None where it is not drawn. The same object as before where nothing has changed."""
        if occurrence.camera_role not in ("seen", "holdout"):
            return None
        if is_hidden(occurrence.hiders, context.time):
            return None
        try:
            poses, numbers, picked_as = places_of(occurrence, context)
        except PlaceError as problem:
            note_problem(problem, context.log)
            return None
        cloud = self._cloud(occurrence, context)
        if cloud is None:
            return None
        shown = context.levels.shows(occurrence.levels, len(poses))
        poses, own_numbers = poses[shown] @ shrink(context), numbers[shown] if occurrence.chain else None
        kept = self._batches.get(number)
        if kept is None or kept.cloud is not cloud or not _stands_as(kept, poses, own_numbers):
            is_holdout = occurrence.camera_role == "holdout"
            prim_id, source_id = context.prim_id(picked_as), context.prim_id(occurrence.path)
            kept = self._batches[number] = SplatBatch(cloud, poses, prim_id, source_id, own_numbers, is_holdout)
        return kept

    def _cloud(self, occurrence: Occurrence, context: DrawContext) -> SplatCloud | None:
        """The splats of an occurrence; None, with a finding, where they cannot be used."""
        key, prim = str(occurrence.source), occurrence.prim
        time = context.time if splats_vary(prim) else None
        if key not in self._clouds or self._clouds[key][0] != time:
            self._clouds[key] = time, None
            try:
                self._clouds[key] = time, read_splats(prim, context.time, context.scale, context.log)
            except BadGeometry as problem:
                context.log.add("bad_geometry", occurrence.path, f"{occurrence.path} is not drawn: {problem}")
        return self._clouds[key][1]


def _stands_as(batch: SplatBatch, poses: DoubleArray, numbers: IntArray | None) -> bool:
    """Whether a batch has these poses and these numbers of instances."""
    own = batch.instance_numbers
    same = own is numbers if own is None or numbers is None else np.array_equal(own, numbers)
    return same and np.array_equal(batch.poses, poses)
