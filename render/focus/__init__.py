"""Focus points, the focus that they request, and focus curves over time. Numpy alone: no USD, no GL.

`files` writes and reads curves; it is imported by itself, since pictures do without it.
"""

from render.focus.best_stop import StopSolutions, stops_for
from render.focus.curve import FocusCurve, PointTrack
from render.focus.solve import (
    FocusSolution,
    FocusSolutions,
    FocusTarget,
    FocusTargets,
    PointState,
    solve_distances,
    solve_focus,
)
from render.model.lens_law import LensLaw

__all__ = [
    "FocusCurve",
    "FocusSolution",
    "FocusSolutions",
    "FocusTarget",
    "FocusTargets",
    "LensLaw",
    "PointState",
    "PointTrack",
    "StopSolutions",
    "solve_distances",
    "solve_focus",
    "stops_for",
]
