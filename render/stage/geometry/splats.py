"""Gaussian splats of a prim (UsdVolParticleField3DGaussianSplat), in its own space."""

from __future__ import annotations

from collections.abc import Sized

import numpy as np
from numpy.typing import NDArray
from pxr import Usd

from render import colour
from render.model.arrays import FloatArray
from render.model.splats import MAX_SPLATS, SplatCloud, is_usable
from render.stage.findings import FindingLog
from render.stage.geometry.polygons import FARTHEST_POINT, BadGeometry
from render.stage.values import UNREADABLE, format_value, why_unreadable

HARMONICS, DEGREE = "radiance:sphericalHarmonicsCoefficients", "radiance:sphericalHarmonicsDegree"
_HALVES = {
    "positions": "positionsh",
    "scales": "scalesh",
    "orientations": "orientationsh",
    "opacities": "opacitiesh",
    HARMONICS: "radiance:sphericalHarmonicsCoefficientsh",
}
"""Attributes of splats, with their twins in half precision, which count where these have no values."""
_MOST_DEGREE = 3
_MOST_RADIANCE = 1e4
"""Coefficients beyond are taken for damage: the layers hold no brighter light."""
_ENCODED, _LINEAR = "srgb_rec709_scene", ("lin_rec709_scene", "lin_rec709")


def splats_vary(prim: Usd.Prim) -> bool:
    """Whether a prim's splats may change over time in its own space."""
    attributes = (prim.GetAttribute(name) for names in _HALVES.items() for name in names)
    return any(attribute and attribute.ValueMightBeTimeVarying() for attribute in attributes)


def read_splats(prim: Usd.Prim, time: Usd.TimeCode, scale: float, log: FindingLog) -> SplatCloud:
    """The splats of a prim at a time; those that cannot be used are left out, with a finding for all of them.

    Args:
        prim: a ParticleField3DGaussianSplat.
        time: when.
        scale: metres in a unit of the stage.
        log: for findings.

    Raises:
        BadGeometry: none can be used, or there are too many; the message explains the fault.
    """
    try:
        return _read(prim, time, scale, log)
    except BadGeometry:
        raise
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem


def read_positions(prim: Usd.Prim, time: Usd.TimeCode) -> FloatArray:
    """Positions ``(n, 3)`` of a prim's splats at a time, in its own space and units.

    Raises:
        BadGeometry: there are none, or too many, or they are no list of points.
    """
    positions = _rows(prim, "positions", 3, time)
    if positions is None:
        raise BadGeometry("it has no positions at this time")
    return positions


def read_ellipsoids(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[FloatArray, FloatArray]:
    """Positions ``(n, 3)`` and axes ``(n, 3, 3)``, in columns, of a prim's splats at a time, in its own space and units.

    Raises:
        BadGeometry: there are no positions, or too many, or the lists are none.
    """
    positions = read_positions(prim, time)
    scales, turns = (_rows(prim, name, width, time) for name, width in (("scales", 3), ("orientations", 4)))
    count = min(len(rows) for rows in (positions, scales, turns) if rows is not None)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        axes = _axes(count, *(None if rows is None else rows[:count] for rows in (scales, turns)))
    return positions[:count], axes


def _read(prim: Usd.Prim, time: Usd.TimeCode, scale: float, log: FindingLog) -> SplatCloud:
    positions = read_positions(prim, time)
    lists = {name: _rows(prim, name, width, time) for name, width in (("scales", 3), ("orientations", 4))}
    lists["opacities"] = _rows(prim, "opacities", 1, time)
    per_splat, harmonics = _harmonics(prim, time, log)
    count = _common_count(prim, len(positions), lists, harmonics, per_splat, log)
    scales, turns, opacities = (None if rows is None else rows[:count] for rows in lists.values())
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        axes = _axes(count, scales, turns) * np.float32(scale)
        cloud = SplatCloud(
            positions=positions[:count] * np.float32(scale),
            axes=axes,
            opacities=np.ones(count, np.float32) if opacities is None else opacities[:, 0],
            harmonics=np.zeros((count, 1, 3), np.float32)
            if harmonics is None
            else harmonics[: count * per_splat].reshape(count, per_splat, 3)[:, : (_MOST_DEGREE + 1) ** 2],
            is_encoded=_is_encoded(prim, log),
            to_working=np.asarray(colour.to_working(np.eye(3, dtype=np.float32)).T, np.float64),
        )
    return _usable(prim, cloud, scale, log)


def _usable(prim: Usd.Prim, cloud: SplatCloud, scale: float, log: FindingLog) -> SplatCloud:
    """The splats of a cloud that can be drawn."""
    path, most_m = prim.GetPath(), FARTHEST_POINT * scale
    is_good = is_usable(cloud) | (np.isfinite(cloud.opacities) & (cloud.opacities <= 0))
    is_good &= (np.abs(cloud.positions) <= most_m).all(axis=1) & (np.abs(cloud.axes) <= most_m).all(axis=(1, 2))
    is_good &= (np.abs(cloud.harmonics) <= _MOST_RADIANCE).all(axis=(1, 2))
    bad = len(is_good) - int(is_good.sum())
    if bad == len(is_good):
        raise BadGeometry("its splats have numbers that are not finite or out of range")
    if bad:
        message = (
            f"{bad:,} of {len(is_good):,} splats of {path} are not drawn: their numbers are not finite or out of range"
        )
        log.add("bad_splats", path, message)
    drawn = is_good & (cloud.opacities > 0)
    return SplatCloud(
        cloud.positions[drawn],
        cloud.axes[drawn],
        np.minimum(cloud.opacities[drawn], np.float32(1)),
        cloud.harmonics[drawn],
        cloud.is_encoded,
        cloud.to_working,
        None if drawn.all() else np.flatnonzero(drawn),
    )


def _common_count(
    prim: Usd.Prim,
    count: int,
    lists: dict[str, FloatArray | None],
    harmonics: FloatArray | None,
    per_splat: int,
    log: FindingLog,
) -> int:
    """Number of splats that have a value of each list; a finding where the lists have different lengths."""
    lengths = {name: len(rows) for name, rows in lists.items() if rows is not None}
    if harmonics is not None:
        lengths[HARMONICS] = len(harmonics) // per_splat
    wrong = [f"{length:,} of {name}" for name, length in lengths.items() if length != count]
    common = min([count, *lengths.values()])
    if wrong:
        if not common:
            raise BadGeometry(f"it has {count:,} positions, and there is enough for {', '.join(wrong)}")
        message = (
            f"{prim.GetPath()} has {count:,} positions, and enough for {', '.join(wrong)}: {common:,} splats are drawn"
        )
        log.add("bad_splats_count", prim.GetPath(), message)
    return common


def _harmonics(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> tuple[int, FloatArray | None]:
    """Coefficients of each splat in number, and all of them ``(m, 3)``; None for grey ones."""
    degree, path = prim.GetAttribute(DEGREE).Get(time), prim.GetPath()
    if not isinstance(degree, int) or not 0 <= degree <= 10:
        raise BadGeometry(f"its {DEGREE} must be a whole number from 0 to {_MOST_DEGREE}, got {format_value(degree)}")
    if degree > _MOST_DEGREE:
        message = f"{path} has spherical harmonics of degree {degree}: those up to {_MOST_DEGREE} are drawn"
        log.add("splats_degree", path, message)
    return (degree + 1) ** 2, _rows(prim, HARMONICS, 3, time, (degree + 1) ** 2)


def _rows(prim: Usd.Prim, name: str, width: int, time: Usd.TimeCode, per_splat: int = 1) -> FloatArray | None:
    """``(m, width)`` an attribute's list, or that of its twin in half precision; None where both are empty.

    Raises:
        BadGeometry: it is no such list, or too long.
    """
    for attribute in (prim.GetAttribute(name), prim.GetAttribute(_HALVES[name])):
        value = attribute.Get(time) if attribute else None
        if value is None or (isinstance(value, Sized) and not len(value)):
            continue
        if isinstance(value, Sized) and len(value) > MAX_SPLATS * per_splat:
            raise BadGeometry(f"it has {len(value) // per_splat:,} splats, and at most {MAX_SPLATS:,} can be drawn")
        with np.errstate(over="ignore"):
            rows = np.array(value, np.float32)
        if rows.ndim == 1:
            rows = rows[:, None]
        if rows.ndim != 2 or rows.shape[1] != width:
            raise BadGeometry(
                f"its {attribute.GetName()} must be a list of {width} numbers each, got {format_value(value)}"
            )
        return rows
    return None


def _axes(count: int, scales: FloatArray | None, turns: FloatArray | None) -> FloatArray:
    """``(n, 3, 3)`` axes of ellipsoids in columns, from their lengths and quaternions ``(n, 4)``, real part last."""
    sizes = np.ones((count, 3), np.float32) if scales is None else scales
    if turns is None:
        return np.eye(3, dtype=np.float32) * sizes[:, None]
    return rotations(turns) * sizes[:, None]


def rotations(turns: FloatArray) -> FloatArray:
    """``(n, 3, 3)`` matrices of quaternions ``(n, 4)`` of any length but 0, real part last."""
    x, y, z, w = (turns / np.linalg.norm(turns, axis=1, keepdims=True)).T
    rows: list[list[NDArray[np.float32]]] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=1) for row in rows], axis=1)


def _is_encoded(prim: Usd.Prim, log: FindingLog) -> bool:
    """Whether a prim's colours are encoded as sRGB: unless they say otherwise, since captured ones are made from photographs."""
    for attribute in (prim.GetAttribute(HARMONICS), prim.GetAttribute(_HALVES[HARMONICS])):
        name = str(attribute.GetColorSpace()) if attribute else ""
        if name in _LINEAR:
            return False
        if name and name != _ENCODED:
            path = prim.GetPath()
            message = f"colour space {name} of the splats of {path} is not honoured: they are read as {_ENCODED}"
            log.add("splats_colour_space", path, message)
    return True
