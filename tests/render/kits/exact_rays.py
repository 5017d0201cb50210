"""Dense rays of the independent float64 tracer through a focused lens: what a place of the film gathers."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from render.lab.reference.lens_tracer import TracedRays
from render.lab.reference.lens_tracer import trace as trace_slowly
from render.model.arrays import DoubleArray
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens

SIDE = 240


def trace(
    lens: FocusedLens,
    start: DoubleArray,
    heading: DoubleArray,
    toward: Literal["film", "scene"],
    wavelength_nm: float = D_LINE_NM,
) -> TracedRays:
    surfaces = list(lens.prescription.surfaces)
    surfaces[lens.stop] = replace(surfaces[lens.stop], semi_diameter_mm=lens.stop_radius_mm)
    heading = heading / np.linalg.norm(heading, axis=1, keepdims=True)
    return trace_slowly(surfaces, lens.vertices_mm, wavelength_nm, start, heading, toward=toward)


def grid(box: DoubleArray) -> tuple[DoubleArray, DoubleArray]:
    """Centres of a box's cells, and the size of one."""
    step = (box[1] - box[0]) / SIDE
    lines = [box[0, axis] + step[axis] * (np.arange(SIDE) + 0.5) for axis in (0, 1)]
    return np.stack(np.meshgrid(*lines), axis=-1).reshape(-1, 2), step


def exact_light(lens: FocusedLens, height_mm: float) -> float:
    """``∫ cos⁴ dA / d²`` over the plane of the rear vertex, of rays that reach the scene: what a pixel gathers."""
    away = lens.film_mm - float(lens.vertices_mm[-1])
    box = np.array([[-1.8, -1.8], [1.8, 1.8]]) * lens.prescription.surfaces[-1].semi_diameter_mm
    for _ in range(2):  # the second time only around what is open
        points, step = grid(box)
        heading = np.column_stack([points - [0.0, -height_mm], np.full(len(points), -away)])
        start = np.tile([0.0, -height_mm, lens.film_mm], (len(points), 1))
        passes = trace(lens, start, heading, "scene").passes
        if not passes.any():
            return 0.0
        light = float(((away / np.linalg.norm(heading[passes], axis=1)) ** 4).sum() * step.prod()) / away**2
        box = np.array([points[passes].min(axis=0) - 2 * step, points[passes].max(axis=0) + 2 * step])
    return light
