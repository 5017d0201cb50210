"""A singlet whose stop has an opening or an obscuration."""

from __future__ import annotations

import numpy as np

from render.model.lens import Glass, Outline, Prescription, Surface
from render.optics.prescription.tracing import trace_forward

RADIUS = 10.0


def lens(opening: Outline | None = None, obscuration: Outline | None = None) -> Prescription:
    """A singlet with the stop before it, which has the outlines."""
    return Prescription(
        (
            Surface(0.0, 2.0, semi_diameter_mm=RADIUS, is_stop=True, opening=opening, obscuration=obscuration),
            Surface(100.0, 4.0, Glass(1.5), 16.0),
            Surface(-100.0, 0.0, semi_diameter_mm=16.0),
        ),
        name="the singlet",
    )


def passed_share(prescription: Prescription, side: int = 801) -> float:
    """Share of the light along the axis on the disc of the stop that gets through."""
    line = (np.arange(side) + 0.5) / side * 2 * RADIUS - RADIUS
    points = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    points = points[np.hypot(*points.T) < RADIUS]
    starts = np.column_stack([points, np.full(len(points), -5.0)])
    traced = trace_forward(prescription, starts, np.tile([0.0, 0.0, 1.0], (len(points), 1)))
    return float(traced.passes.mean())


DISC = np.pi * RADIUS**2
