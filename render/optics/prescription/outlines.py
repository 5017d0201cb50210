"""Openings and obscurations of surfaces: light that they stop besides clear diameters and the iris."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Outline, Prescription, Surface

_SIDE = 101  # points across a clear aperture in which an open one is looked for


def excess(outline: Outline, points: DoubleArray) -> DoubleArray:
    """Square of the distance from the centre over that of the edge in the same direction, less 1: above 0 outside.

    Args:
        outline: of the shape.
        points: ``(..., 2)`` mm from the axis, x across the picture and y up.
    """
    squares = ((points - np.array(outline.centre_mm)) / np.array(outline.half_mm)) ** 2
    return np.asarray((squares.sum(axis=-1) if outline.kind == "ellipse" else squares.max(axis=-1)) - 1)


def clearance(surface: Surface, points: DoubleArray) -> DoubleArray:
    """Clearance at points ``(..., 2)`` of a surface: above 0 its opening or its obscuration stops light; −1 without both."""
    stops = np.full(points.shape[:-1], -1.0)
    if surface.opening is not None:
        stops = np.maximum(stops, excess(surface.opening, points))
    if surface.obscuration is not None:
        stops = np.maximum(stops, -excess(surface.obscuration, points))
    return np.asarray(stops)


def is_circle(outline: Outline) -> bool:
    """Whether it is one, about the axis or beside it."""
    return outline.kind == "ellipse" and outline.half_mm[0] == outline.half_mm[1]


def reach_mm(outline: Outline) -> float:
    """Distance from the axis of an outline's farthest point."""
    (a, b), (x, y) = outline.half_mm, np.abs(outline.centre_mm)
    if outline.kind == "rectangle":
        return float(np.hypot(x + a, y + b))
    if is_circle(outline):
        return float(np.hypot(x, y) + a)
    angle = np.linspace(0, np.pi / 2, 721)
    return float(np.hypot(x + a * np.cos(angle), y + b * np.sin(angle)).max())


def is_closed(surface: Surface) -> bool:
    """Whether opening, obscuration and clear diameter leave nothing open; False where how wide it is is unknown."""
    rim, opening = surface.semi_diameter_mm, surface.opening
    if opening is None and (rim <= 0 or surface.obscuration is None):
        return False
    angle = np.linspace(0, 2 * np.pi, 4 * _SIDE)
    edge = (1 - 1e-6) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    square = np.stack(np.meshgrid(*2 * [np.linspace(-1, 1, _SIDE)]), axis=-1).reshape(-1, 2)
    places = np.concatenate([square, edge])  # a narrow ring may lie between the points of the square
    if opening is not None:
        places = np.array(opening.centre_mm) + places * np.array(opening.half_mm)
        places = np.concatenate([places, edge * rim])
    else:
        places = places * rim
    is_open = clearance(surface, places) < 0
    return not (is_open & ((np.hypot(*places.T) < rim) | (rim <= 0))).any()


def is_centred(prescription: Prescription) -> bool:
    """Whether all of its outlines are the same left and right, and up and down."""
    return all(outline.centre_mm == (0.0, 0.0) for outline in prescription.outlines)


def without_outlines(prescription: Prescription) -> Prescription:
    """The lens with its clear diameters and its iris alone; itself where it has no outlines."""
    if not prescription.outlines:
        return prescription
    surfaces = tuple(replace(surface, opening=None, obscuration=None) for surface in prescription.surfaces)
    return replace(prescription, surfaces=surfaces)


def scaled(outline: Outline | None, factor: float) -> Outline | None:
    """The outline with all lengths times the factor."""
    if outline is None:
        return None
    (a, b), (x, y) = outline.half_mm, outline.centre_mm
    return replace(outline, half_mm=(a * factor, b * factor), centre_mm=(x * factor, y * factor))


def turned(outline: Outline | None) -> Outline | None:
    """The outline turned by a quarter about the axis, from the x axis to the y axis."""
    if outline is None:
        return None
    (a, b), (x, y) = outline.half_mm, outline.centre_mm
    return replace(outline, half_mm=(b, a), centre_mm=(-y, x))
