"""Focus points, the focus that they request, and focus curves over time. Numpy alone: no USD, no GL."""

from render.focus.best_stop import StopSolutions, stops_for
from render.focus.curve import FocusCurve, PointTrack
from render.focus.files import curve_to_csv, curve_to_dict, curve_to_json
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
    "curve_to_csv",
    "curve_to_dict",
    "curve_to_json",
    "solve_distances",
    "solve_focus",
    "stops_for",
]
