"""Greatest distance from the origin at which single-precision vertices are accurate enough."""

from __future__ import annotations

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.stage.findings import FindingLog

# From here on neighbouring single precision numbers are 6 cm and more apart.
_FAR_M = 1e6
# Beyond it squares of distances overflow.
_OUT_OF_RANGE_M = 1e15


def is_placeable(positions: FloatArray, matrix: DoubleArray, path: str, log: FindingLog) -> bool:
    """Whether a surface can be drawn where its matrix puts it; notes a finding where that is not exact, or not at all.

    Args:
        positions: ``(n, 3)`` in the surface's own space.
        matrix: ``(4, 4)`` to metres from that space.
        path: of the surface.
        log: for the finding.
    """
    if not len(positions):
        return True
    reach = np.abs(positions).max(axis=0).astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        # At most this far on any axis: near enough to tell metres from thousands of kilometres.
        farthest_m = float((np.abs(matrix[:3, :3]) @ reach + np.abs(matrix[:3, 3])).max())
    if not farthest_m <= _OUT_OF_RANGE_M:
        log.add("bad_geometry", path, f"{path} is not drawn: it reaches {farthest_m:g} m from the origin, out of range")
        return False
    if farthest_m > _FAR_M:
        step_m = float(np.spacing(np.float32(farthest_m)))
        message = f"{path} reaches {farthest_m:g} m from the origin: its vertices are placed to {step_m:g} m"
        log.add("far_geometry", path, message)
    return True
