"""IES photometric files: how bright a luminaire is in each direction (ANSI/IES LM-63-2019), as a table by direction.

Intensity is candela times the file's multiplier and ballast factors. Only type C is read: its vertical angle 0 is a light's -Z,
its horizontal angle 0 a light's +X.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import PROFILE_SHAPE
from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import as_file, require_inside

_MAX_BYTES = 4 * 2**20
_MAX_ANGLES = 100_000
_MAX_AROUND = 1000  # horizontal angles; the table of a light has far fewer
_MOST = 1e9
_FIXED = 13  # numbers before the angles
_BLANKS = re.compile(r"[\s,]+")


class ProfileError(ValueError):
    """Photometric file that cannot be used; the message gives the reason."""


@dataclass(frozen=True, eq=False)
class Photometry:
    """Photometry of a luminaire.

    Attributes:
        vertical: ``(v,)`` angles from the luminaire's axis, radians, ascending.
        horizontal: ``(h,)`` angles around it, radians, ascending.
        intensity: ``(h, v)`` candela.
    """

    vertical: DoubleArray
    horizontal: DoubleArray
    intensity: DoubleArray

    def at(self, polar: DoubleArray, azimuth: DoubleArray) -> DoubleArray:
        """Intensity ``(h, v)`` in candela at angles ``(v,)`` and ``(h,)``, radians; 0 beyond the vertical angles of the file."""
        around = np.degrees(azimuth) % 360
        first, last = np.degrees(self.horizontal[[0, -1]])
        if len(self.horizontal) == 1:
            around = np.full_like(around, first)
        elif first == 90:
            around = np.where(around < 90, 180 - around, np.where(around > 270, 540 - around, around))
        elif last == 90:
            around = np.minimum(around % 180, 180 - around % 180)
        elif last == 180:
            around = np.minimum(around, 360 - around)
        columns = np.stack([np.interp(polar, self.vertical, row, left=0.0, right=0.0) for row in self.intensity])
        places = np.interp(np.radians(around), self.horizontal, np.arange(len(self.horizontal)))
        below = np.floor(places).astype(int)
        above = np.minimum(below + 1, len(self.horizontal) - 1)
        share = (places - below)[:, None]
        return np.asarray((1 - share) * columns[below] + share * columns[above])

    def mean(self) -> float:
        """Mean intensity over the sphere, or over the hemisphere that it shines into, where it shines into one alone: what
        ``normalize`` divides by, as in USD's reference renderer (hdEmbree)."""
        polar, azimuth = (np.arange(720) + 0.5) / 720 * np.pi, (np.arange(72) + 0.5) / 72 * 2 * np.pi
        shown = self.at(polar, azimuth).mean(0)
        weights = np.sin(polar)
        lit = [bool(shown[half].any()) for half in (slice(0, 360), slice(360, 720))]
        return float((shown * weights).sum() / weights.sum()) * (1 if all(lit) else 2)


def read_profile(resolved_path: str, confined_to: Path | None, angle_scale: float, *, normalize: bool) -> FloatArray:
    """Multiplier of a light by direction, as `render.model.scene.Light.profile`.

    Args:
        resolved_path: as Ar resolves it; may be inside a package.
        confined_to: the folder that the file must lie in, or None.
        angle_scale: stretches the vertical angles from 0 by it where it is above 0, from pi by its amount where it is below 0.
        normalize: keep the light's mean intensity.

    Raises:
        ProfileError: the file is missing, outside the folder, or damaged.
    """
    try:
        require_inside(resolved_path, confined_to)
        with as_file(resolved_path) as file, open(file, "rb") as handle:
            data = handle.read(_MAX_BYTES + 1)
    except (TextureError, OSError) as problem:
        raise ProfileError(str(problem) if isinstance(problem, TextureError) else "cannot be read") from problem
    if len(data) > _MAX_BYTES:
        raise ProfileError(f"is larger than {_MAX_BYTES // 2**20} MiB")
    return bake(parse(data.decode("latin-1")), angle_scale, normalize=normalize)


def bake(photometry: Photometry, angle_scale: float, *, normalize: bool) -> FloatArray:
    """Table of a photometry, as `read_profile`."""
    around, along = PROFILE_SHAPE
    polar, azimuth = np.linspace(0, np.pi, along), (np.arange(around) + 0.5) / around * 2 * np.pi
    if angle_scale > 0:
        polar = polar / angle_scale
    elif angle_scale < 0:
        polar = np.pi + (polar - np.pi) / -angle_scale
    mean = photometry.mean() if normalize else 1.0
    if mean <= 0:
        raise ProfileError("is dark")
    table = photometry.at(polar, azimuth) / max(mean, 1 / _MOST)
    if not (table <= _MOST).all():
        raise ProfileError("is too bright where it shines, for its mean")
    return np.asarray(table, np.float32)


def parse(text: str) -> Photometry:
    """Parse a photometric file.

    Raises:
        ProfileError: it is none, or of another type than C, or its numbers contradict each other.
    """
    head, found, rest = text.partition("TILT=")
    if not found or not head.lstrip().startswith("IES"):
        raise ProfileError("is no photometric file: it must begin with IES and have a line TILT=")
    tilt, _, body = rest.partition("\n")
    numbers = _Numbers([word for word in _BLANKS.split(body) if word])
    if tilt.strip() == "INCLUDE":
        numbers.take(1)
        numbers.take(2 * numbers.count("angles of its tilt"))
    fixed = numbers.take(3)
    vertical_count, horizontal_count = numbers.count("vertical angles"), numbers.count("horizontal angles")
    kind = numbers.take(_FIXED - 5)
    if kind[0] != 1:
        raise ProfileError(f"has the photometric type {kind[0]:g}: only 1, type C, is read")
    if horizontal_count > _MAX_AROUND or vertical_count * horizontal_count > 2**20:
        raise ProfileError(f"has {vertical_count} times {horizontal_count} angles, which are too many")
    vertical, horizontal = numbers.take(vertical_count), numbers.take(horizontal_count)
    candela = numbers.take(vertical_count * horizontal_count).reshape(horizontal_count, vertical_count)
    if (np.diff(vertical) <= 0).any() or (np.diff(horizontal) <= 0).any() or vertical[0] < 0 or vertical[-1] > 180:
        raise ProfileError("has angles that do not ascend from 0 to 180 and 360 degrees")
    if horizontal_count > 1 and (horizontal[0], horizontal[-1]) not in ((0, 90), (0, 180), (0, 360), (90, 270)):
        raise ProfileError(
            f"has horizontal angles from {horizontal[0]:g} to {horizontal[-1]:g} degrees, which do not close"
        )
    factors = fixed[2] * kind[-3] * kind[-2]
    intensity = np.maximum(candela, 0) * max(factors, 0.0)
    if not (intensity <= _MOST).all():
        raise ProfileError("is too bright")
    return Photometry(np.radians(vertical), np.radians(horizontal), intensity)


class _Numbers:
    """Numbers of a file, in order."""

    def __init__(self, words: list[str]) -> None:
        self._words, self._next = words, 0

    def take(self, count: int) -> DoubleArray:
        """The next numbers."""
        words = self._words[self._next : self._next + count]
        if len(words) < count:
            raise ProfileError("ends too early")
        self._next += count
        try:
            values = np.array([float(word) for word in words], np.float64)
        except ValueError as problem:
            raise ProfileError("has words among its numbers") from problem
        if not (np.abs(values) <= _MOST).all():
            raise ProfileError("has numbers that are out of range")
        return values

    def count(self, what: str) -> int:
        """The next number, of things that follow."""
        value = float(self.take(1)[0])
        if not (1 <= value <= _MAX_ANGLES and value == int(value)):
            raise ProfileError(f"has {value:g} {what}")
        return int(value)
