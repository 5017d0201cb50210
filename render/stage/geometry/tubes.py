"""Polygons along curves: round tubes, and flat ribbons that face their normals."""

from __future__ import annotations

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, FloatArray, IntArray, LongArray
from render.stage.geometry.curve_samples import CurveSamples
from render.stage.geometry.polygons import Polygons, Values
from render.stage.geometry.sampling import Sampling

_MOST_STRETCH = 4.0
"""Length of a mitre relative to the tube's radius, beyond which sharp corners are cut."""
_SIDES = ((1 << 13, 24), (1 << 15, 12), (1 << 17, 8), (1 << 19, 5))
"""Samples of a prim up to which tubes have so many sides."""
_FEWEST_SIDES = 3


def make_tubes(samples: CurveSamples, widths: FloatArray) -> Polygons:
    """Make tubes around curves, with flat ends.

    A tube's sides stand so far out that its width, averaged over all directions of view, is exact (Cauchy: the perimeter over π).

    Args:
        samples: along the curves.
        widths: ``(n,)`` diameter at each sample.
    """
    sides = next((sides for most, sides in _SIDES if len(samples.positions) <= most), _FEWEST_SIDES)
    tangents, side = _frames(samples)
    up = np.cross(tangents, side)
    angle = np.arange(sides) * (2 * np.pi / sides)
    around = np.cos(angle)[:, None] * side[:, None] + np.sin(angle)[:, None] * up[:, None]
    radius = widths.astype(np.float64) / 2 * (np.pi / (sides * np.sin(np.pi / sides)))
    rings = samples.positions[:, None] + radius[:, None, None] * _mitred(samples, around)
    here = np.flatnonzero(samples.following >= 0)
    quads = _quads(here, samples.following[here], sides)
    first, last = _ends(samples)
    count = len(rings) * sides
    caps = count + np.arange(2 * len(first) * sides).reshape(2, len(first), sides)
    caps[0] = caps[0, :, ::-1]
    cap_places = np.concatenate([first, last])
    cap_normals = np.concatenate([-tangents[first], tangents[last]])
    places = np.concatenate([np.repeat(np.arange(len(rings)), sides), np.repeat(cap_places, sides)])
    return Polygons(
        points=np.concatenate([rings.reshape(-1, 3), rings[cap_places].reshape(-1, 3)]).astype(np.float32),
        counts=np.concatenate([np.full(len(quads), 4), np.full(2 * len(first), sides)]).astype(np.int32),
        corners=np.concatenate([quads.ravel(), caps.ravel()]).astype(np.int32),
        normals=_at_points(np.concatenate([around.reshape(-1, 3), np.repeat(cap_normals, sides, axis=0)])),
        sampling=_sampling(samples, places, np.concatenate([np.repeat(here, sides), cap_places])),
    )


def make_ribbons(samples: CurveSamples, widths: FloatArray, normals: DoubleArray) -> Polygons:
    """Make flat ribbons along curves.

    Args:
        samples: along the curves.
        widths: ``(n,)`` width at each sample.
        normals: ``(n, 3)`` directions that the ribbons face, of any length.
    """
    tangents = _tangents(samples)
    across = np.cross(normals, tangents)
    across = _unit(across, _perpendicular(tangents))
    half = widths.astype(np.float64)[:, None] / 2 * across
    edges = np.stack([samples.positions - half, samples.positions + half], axis=1)
    facing = np.cross(tangents, across)
    here = np.flatnonzero(samples.following >= 0)
    left, right = 2 * here, 2 * here + 1
    after = 2 * samples.following[here]
    quads = np.stack([left, after, after + 1, right], axis=1)
    return Polygons(
        points=edges.reshape(-1, 3).astype(np.float32),
        counts=np.full(len(quads), 4, np.int32),
        corners=quads.ravel().astype(np.int32),
        normals=_at_points(np.repeat(facing, 2, axis=0)),
        sampling=_sampling(samples, np.repeat(np.arange(len(edges)), 2), here),
    )


def _at_points(normals: DoubleArray) -> Values:
    return Values(normals.astype(np.float32), "vertex")


def _sampling(samples: CurveSamples, places: LongArray, places_of_faces: LongArray) -> Sampling:
    return Sampling(samples.vertex, samples.varying, places, samples.curve[places_of_faces])


def _quads(here: LongArray, after: LongArray, sides: int) -> IntArray:
    """``(n·sides, 4)`` point numbers of the quads between rings, counter-clockwise from outside."""
    side = np.arange(sides)
    beside = (side + 1) % sides
    first, second = here[:, None] * sides, after[:, None] * sides
    quads = np.stack([first + side, first + beside, second + beside, second + side], axis=-1)
    return quads.reshape(-1, 4).astype(np.int32)


def _ends(samples: CurveSamples) -> tuple[LongArray, LongArray]:
    """First and last samples of open curves."""
    is_open = ~samples.closed & (np.diff(samples.starts) > 0)
    return samples.starts[:-1][is_open], samples.starts[1:][is_open] - 1


def _tangents(samples: CurveSamples) -> DoubleArray:
    """``(n, 3)`` unit directions: at corners the mean of those on both sides, at cusps that of the neighbours."""
    following, before = samples.following, _before(samples)
    rows = np.arange(len(following))
    after, back = np.where(following < 0, rows, following), np.where(before < 0, rows, before)
    chords = samples.positions[after] - samples.positions[back]
    if not samples.bends:
        return _unit(samples.directions, _unit(chords, _up(len(rows))))
    both = _unit(samples.positions[after] - samples.positions, 0 * chords)
    both += _unit(samples.positions - samples.positions[back], 0 * chords)
    return _unit(both, _unit(chords, _up(len(rows))))


def _before(samples: CurveSamples) -> LongArray:
    """``(n,)`` the sample before each one; -1 at the begin of an open curve."""
    before = np.full(len(samples.positions), -1)
    here = np.flatnonzero(samples.following >= 0)
    before[samples.following[here]] = here
    return before


def _mitred(samples: CurveSamples, around: DoubleArray) -> DoubleArray:
    """Directions of rings, stretched in the plane of a corner so that tubes keep their width beside it."""
    if not samples.bends:
        return around
    rows, following, before = np.arange(len(around)), samples.following, _before(samples)
    inner = (following >= 0) & (before >= 0)
    after, back = np.where(inner, following, rows), np.where(inner, before, rows)
    away = _unit(samples.positions[after] - samples.positions, np.zeros((len(rows), 3)))
    along = _unit(samples.positions - samples.positions[back], np.zeros((len(rows), 3)))
    bend = away - along
    half_angle_sin = np.linalg.norm(bend, axis=1) / 2
    stretch = 1 / np.sqrt(np.maximum(1 - half_angle_sin**2, _MOST_STRETCH**-2))
    bend = _unit(bend, np.zeros((len(rows), 3)))
    inward = np.einsum("nsk,nk->ns", around, bend)
    mitred: DoubleArray = around + ((stretch - 1)[:, None] * inward)[..., None] * bend[:, None]
    return mitred


def _frames(samples: CurveSamples) -> tuple[DoubleArray, DoubleArray]:
    """Unit tangents ``(n, 3)``, and sides ``(n, 3)`` across them that turn about them as little as can be.

    A side is carried from sample to sample by the smallest turn that takes one tangent to the next (Bloomenthal 1990); products
    of these turns are made by a scan, all curves at once. On a closed curve what is left at the seam is spread over all samples.
    """
    tangents = _tangents(samples)
    starts = samples.starts[:-1][np.diff(samples.starts) > 0]
    is_first = np.zeros(len(tangents), bool)
    is_first[starts] = True
    before = np.where(is_first, np.arange(len(tangents)), np.arange(len(tangents)) - 1)
    turns = _scan(_smallest_turns(tangents[before], tangents), is_first)
    first = starts[np.cumsum(is_first) - 1]
    sides = _rotate(turns, _perpendicular(tangents)[first])
    sides = _unit(sides - np.sum(sides * tangents, axis=1, keepdims=True) * tangents, _perpendicular(tangents))
    return tangents, _close(samples, tangents, sides) if samples.closed.any() else sides


def _close(samples: CurveSamples, tangents: DoubleArray, sides: DoubleArray) -> DoubleArray:
    """Turn sides of closed curves a little about their tangents, so that the last one goes on in the first."""
    filled = np.flatnonzero(samples.closed & (np.diff(samples.starts) > 0))
    first, last = samples.starts[filled], samples.starts[filled + 1] - 1
    carried = _rotate(_smallest_turns(tangents[last], tangents[first]), sides[last])
    up = np.cross(tangents[first], sides[first])
    angle = np.arctan2(np.sum(carried * up, axis=1), np.sum(carried * sides[first], axis=1))
    missing = np.zeros(len(samples.closed))
    missing[filled] = angle
    count = np.maximum(np.diff(samples.starts), 1)[samples.curve]
    turn = -missing[samples.curve] * (np.arange(len(sides)) - samples.starts[samples.curve]) / count
    turned: DoubleArray = np.cos(turn)[:, None] * sides + np.sin(turn)[:, None] * np.cross(tangents, sides)
    return turned


def _smallest_turns(source: DoubleArray, target: DoubleArray) -> DoubleArray:
    """``(n, 4)`` unit quaternions (real part first) of the smallest turns that take unit vectors to others."""
    real = 1 + np.sum(source * target, axis=1)
    turns = np.concatenate([real[:, None], np.cross(source, target)], axis=1)
    opposite = real < 1e-9
    turns[opposite] = np.concatenate([np.zeros((opposite.sum(), 1)), _perpendicular(source[opposite])], axis=1)
    return np.asarray(turns / np.linalg.norm(turns, axis=1, keepdims=True))


def _scan(turns: DoubleArray, is_first: BoolArray) -> DoubleArray:
    """Products of all turns since the first of each curve (Hillis & Steele 1986), whose own turn is none."""
    product, is_whole = turns.copy(), is_first.copy()
    step = 1
    while not is_whole.all():
        rest = np.flatnonzero(~is_whole)
        product[rest], is_whole[rest] = _multiply(product[rest], product[rest - step]), is_whole[rest - step]
        step *= 2
    return product


def _multiply(a: DoubleArray, b: DoubleArray) -> DoubleArray:
    real = a[:, 0] * b[:, 0] - np.sum(a[:, 1:] * b[:, 1:], axis=1)
    rest = a[:, :1] * b[:, 1:] + b[:, :1] * a[:, 1:] + np.cross(a[:, 1:], b[:, 1:])
    product = np.concatenate([real[:, None], rest], axis=1)
    return np.asarray(product / np.linalg.norm(product, axis=1, keepdims=True))


def _rotate(turns: DoubleArray, vectors: DoubleArray) -> DoubleArray:
    twice = 2 * np.cross(turns[:, 1:], vectors)
    return np.asarray(vectors + turns[:, :1] * twice + np.cross(turns[:, 1:], twice))


def _perpendicular(vectors: DoubleArray) -> DoubleArray:
    """Unit vectors across unit vectors."""
    axis = np.eye(3)[np.argmin(np.abs(vectors), axis=1)]
    return _unit(np.cross(vectors, axis), _up(len(vectors)))


def _unit(vectors: DoubleArray, otherwise: DoubleArray) -> DoubleArray:
    """Vectors at unit length; others where they have none."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    has_length = length > 1e-12
    return np.where(has_length, vectors / np.where(has_length, length, 1), otherwise)


def _up(count: int) -> DoubleArray:
    return np.tile(np.array([0.0, 1.0, 0.0]), (count, 1))
