"""Check of the UDIM tiles that surfaces use against those that there are."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from render.model.arrays import LongArray
from render.model.scene import Batch, Geometry, TextureLookup
from render.model.udim import FIRST_TILE, LAST_TILE, tiles_at
from render.stage.findings import FindingLog

_INWARDS = 1e-3
"""Share of the way to a triangle's middle by which its corners are moved: a surface ends at the border of a tile, not beyond."""
_MOST_NAMED = 8


class TileCheck:
    """Names surfaces that use tiles that their texture sets lack; each pair of a geometry and a material is looked at once."""

    def __init__(self) -> None:
        self._seen: dict[tuple[int, int], Batch] = {}

    def note_missing(self, batches: Sequence[Batch], prim_paths: Sequence[str], log: FindingLog) -> None:
        """Add a finding for each surface and set with missing tiles.

        Args:
            batches: all that is drawn.
            prim_paths: that the prim ids of geometries index.
            log: receives the findings.
        """
        tiled = [batch for batch in batches if any(look.image.tiles for look in batch.material.lookups.values())]
        keys = [(id(batch.geometry), id(batch.material)) for batch in tiled]
        for key, batch in zip(keys, tiled, strict=True):
            if key not in self._seen:
                sets = {look.image.name: look for look in batch.material.lookups.values() if look.image.tiles}
                for name, look in sets.items():
                    _note(batch.geometry, look, name, prim_paths, log)
        self._seen = dict(zip(keys, tiled, strict=True))


def _note(geometry: Geometry, look: TextureLookup, name: str, prim_paths: Sequence[str], log: FindingLog) -> None:
    used = _used_tiles(geometry, look)
    is_missing = ~np.isin(used, look.image.tiles).all(axis=1)
    if not is_missing.any():
        return
    path = prim_paths[geometry.prim_ids[np.argmax(is_missing)]]
    missing = sorted(set(used[is_missing].ravel().tolist()) - set(look.image.tiles))
    beyond = f"places outside of the tiles {FIRST_TILE} to {LAST_TILE}" if missing[0] == 0 else ""
    numbers = [str(number) for number in missing if number]
    more = f" and {len(numbers) - _MOST_NAMED} more" if len(numbers) > _MOST_NAMED else ""
    listed = f"tile{'s' if len(numbers) > 1 else ''} {', '.join(numbers[:_MOST_NAMED])}{more}" if numbers else ""
    what = " and ".join(part for part in (listed, beyond) if part)
    log.add("udim_missing", path, f"{path} uses {what} of texture {name}, which has none there: its fallback is drawn")


def _used_tiles(geometry: Geometry, look: TextureLookup) -> LongArray:
    """``(m, 4)`` tiles at the corners and in the middle of each triangle; 0 where no tile can be."""
    uvs = geometry.coordinates(look)
    if uvs is None:
        return tiles_at(look.uv_transform[None, :, 2].astype(np.float64)).repeat(4)[None]
    places = uvs @ look.uv_transform[:, :2].T.astype(np.float64) + look.uv_transform[:, 2]
    corners = places[geometry.triangles]
    middles = corners.mean(axis=1, keepdims=True)
    inner = np.concatenate([corners + _INWARDS * (middles - corners), middles], axis=1)
    return tiles_at(inner.reshape(-1, 2)).reshape(-1, 4)
