"""Focus points, the focus that they ask for, and focus curves over time. Numpy alone: no USD, no GL."""

from render.focus.curve import FocusCurve, PointTrack
from render.focus.files import curve_to_csv, curve_to_dict, curve_to_json
from render.focus.solve import FocusSolution, FocusTarget, PointState, solve_focus

__all__ = [
    "FocusCurve",
    "FocusSolution",
    "FocusTarget",
    "PointState",
    "PointTrack",
    "curve_to_csv",
    "curve_to_dict",
    "curve_to_json",
    "solve_focus",
]
