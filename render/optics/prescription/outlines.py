"""Openings and obscurations of surfaces: light that they stop besides clear diameters and the iris."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from render.model.arrays import DoubleArray
from render.model.lens import Outline, Prescription, Surface

_SIDE = 101  # points across a clear aperture in which an open one is looked for


def excess(outline: Outline, points: DoubleArray) -> DoubleArray:
    """Square of the distance from the centre over that of the edge in the same direction, less 1: above 0 outside.

    Of a polygon, twice the distance from its edge over the smaller of its half sizes, which grows as much.

    Args:
        outline: of the shape.
        points: ``(..., 2)`` mm from the axis, x across the picture and y up.
    """
    if outline.kind == "polygon":
        return 2 * _beyond_polygon(outline.corners_mm, points) / min(outline.half_mm)
    squares = ((points - np.array(outline.centre_mm)) / np.array(outline.half_mm)) ** 2
    return np.asarray((squares.sum(axis=-1) if outline.kind == "ellipse" else squares.max(axis=-1)) - 1)


def _beyond_polygon(corners_mm: tuple[tuple[float, float], ...], points: DoubleArray) -> DoubleArray:
    """Distance of points from the edge of a polygon, negative within it."""
    squares, inside = np.full(points.shape[:-1], np.inf), np.zeros(points.shape[:-1], bool)
    corners = np.array(corners_mm)
    for begin, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        edge, to_point = end - begin, points - begin
        share = np.clip(to_point @ edge / max(float(edge @ edge), 1e-300), 0.0, 1.0)
        squares = np.minimum(squares, ((to_point - share[..., None] * edge) ** 2).sum(axis=-1))
        spans = (begin[1] <= points[..., 1]) != (end[1] <= points[..., 1])
        is_left = edge[0] * to_point[..., 1] > edge[1] * to_point[..., 0]
        inside ^= spans & (is_left == (edge[1] > 0))
    return np.asarray(np.where(inside, -1.0, 1.0) * np.sqrt(squares))


def polygon(corners_mm: Sequence[tuple[float, float]]) -> Outline:
    """The outline with these corners, at least three."""
    low, high = np.min(corners_mm, axis=0), np.max(corners_mm, axis=0)
    half, centre = (high - low) / 2, (high + low) / 2
    kept = tuple((float(x), float(y)) for x, y in corners_mm)
    return Outline("polygon", (float(half[0]), float(half[1])), (float(centre[0]), float(centre[1])), kept)


def spider(width: float, arms: int, length: float, centre: tuple[float, float] = (0.0, 0.0)) -> Outline:
    """Arms that go out evenly from a centre, the first one to the right, as one polygon.

    Args:
        width: of each arm.
        arms: at least 1.
        length: of each arm from the centre.
        centre: x across the picture and y up.
    """
    half, inner = width / 2, width / 2 / max(np.sin(np.pi / arms), 1e-9)
    corners: list[tuple[float, float]] = []
    for arm in range(arms):
        angle = 2 * np.pi * arm / arms
        along, aside = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
        placed = [length * along - half * aside, length * along + half * aside]
        if arms == 1:
            placed += [half * aside, -half * aside]
        else:
            between = angle + np.pi / arms
            placed.append(inner * np.array([np.cos(between), np.sin(between)]))
        corners += [(float(x + centre[0]), float(y + centre[1])) for x, y in placed]
    return polygon(corners)


class SpiderArms(NamedTuple):
    """Arms of a spider; arguments of `spider`."""

    width: float
    arms: int
    length: float
    centre: tuple[float, float]


def spider_arms(outline: Outline) -> SpiderArms | None:
    """The arms of a polygon that `spider` has made; None of any other."""
    corners = np.array(outline.corners_mm)
    count = 1 if len(corners) == 4 else len(corners) // 3
    if outline.kind != "polygon" or len(corners) not in (4, 3 * count):
        return None
    middle = corners[2:].mean(axis=0) if count == 1 else corners[2::3].mean(axis=0)
    width, length = (
        float(np.hypot(*(corners[1] - corners[0]))),
        float(np.hypot(*((corners[0] + corners[1]) / 2 - middle))),
    )
    arms = SpiderArms(round(width, 9), count, length, (round(float(middle[0]), 9), round(float(middle[1]), 9)))
    made = np.array(spider(*arms).corners_mm)
    return arms if made.shape == corners.shape and np.allclose(made, corners, rtol=0, atol=1e-6 * length) else None


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
    if outline.kind == "polygon":
        return float(np.hypot(*np.transpose(outline.corners_mm)).max())
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
    return all(is_mirrored(outline, axis) for outline in prescription.outlines for axis in (0, 1))


def is_mirrored(outline: Outline, axis: int) -> bool:
    """Whether an outline is the same left and right (0), or up and down (1)."""
    if outline.kind != "polygon":
        return outline.centre_mm[axis] == 0
    corners = np.array(outline.corners_mm)
    mirrored = corners * np.where(np.arange(2) == axis, -1.0, 1.0)
    own, other = (_edges(each, max(outline.half_mm)) for each in (corners, mirrored))
    return own == other


def _edges(corners: DoubleArray, size: float) -> set[frozenset[tuple[int, int]]]:
    """Edges by their ends, to a millionth of a polygon's size."""
    ends = [(int(x), int(y)) for x, y in np.rint(corners / size * 1e6)]
    return {frozenset(edge) for edge in zip(ends, [*ends[1:], ends[0]], strict=True)}


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
    corners = tuple((u * factor, v * factor) for u, v in outline.corners_mm)
    return replace(outline, half_mm=(a * factor, b * factor), centre_mm=(x * factor, y * factor), corners_mm=corners)


def turned(outline: Outline | None) -> Outline | None:
    """The outline turned by a quarter about the axis, from the x axis to the y axis."""
    if outline is None:
        return None
    (a, b), (x, y) = outline.half_mm, outline.centre_mm
    return replace(outline, half_mm=(b, a), centre_mm=(-y, x), corners_mm=tuple((-v, u) for u, v in outline.corners_mm))
