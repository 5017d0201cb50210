"""The ASC Colour Decision List: slope, offset, power and saturation, from numbers or from a file.

    v = clamp-free (slope · x + offset) ^ power          luma = 0.2126 R + 0.7152 G + 0.0722 B
    out = luma + saturation · (v − luma)

ASC CDL Transfer Functions and Interchange Syntax, version 1.2 (2009), without its clamps to 0..1: light brighter than white is
light. OpenColorIO does both the arithmetic and the files (.cdl, .cc, .ccc).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import PyOpenColorIO

from render.colour import OCIO_ERRORS, file_stamp
from render.errors import InputError, SettingsError
from render.near_names import hint

Triple = tuple[float, float, float]


def _check(name: str, numbers: tuple[float, ...], expected: str, least: float, count: int = 3) -> None:
    """Raise `SettingsError` unless there are ``count`` finite numbers, none below the least."""
    if len(numbers) != count or not all(math.isfinite(number) and number >= least for number in numbers):
        got = ", ".join(f"{number:g}" for number in numbers)
        raise SettingsError(f"the CDL's {name} must be {expected}, got {got or 'none'}", code="bad_cdl")


@dataclass(frozen=True)
class Cdl:
    """ASC colour decision on red, green and blue, and on their saturation.

    Attributes:
        slope: factors, from 0 up.
        offset: addends.
        power: exponents, above 0.
        saturation: 0 is grey, 1 leaves the colours.

    Raises:
        SettingsError: a number is out of range or not finite; the message names it.
    """

    slope: Triple = (1.0, 1.0, 1.0)
    offset: Triple = (0.0, 0.0, 0.0)
    power: Triple = (1.0, 1.0, 1.0)
    saturation: float = 1.0

    def __post_init__(self) -> None:
        _check("slope", self.slope, "three numbers from 0 up", 0.0)
        _check("offset", self.offset, "three finite numbers", -math.inf)
        _check("power", self.power, "three numbers above 0", math.ulp(0.0))
        _check("saturation", (self.saturation,), "a number from 0 up", 0.0, count=1)

    @property
    def is_neutral(self) -> bool:
        """Whether it changes nothing."""
        return self == NEUTRAL

    def transform(self) -> PyOpenColorIO.CDLTransform:
        """OpenColorIO's transform of it, on values of whatever space they are in."""
        return PyOpenColorIO.CDLTransform(self.slope, self.offset, self.power, self.saturation)  # style: no clamp


NEUTRAL = Cdl()


def read_cdl(path: str | Path, correction: str = "") -> Cdl:
    """A correction of a .cdl, .cc or .ccc file.

    Args:
        path: of the file.
        correction: its id; or its number, counted from 0; empty takes the first.

    Raises:
        InputError: the file is missing or damaged (code ``bad_cdl``), or has no such correction (``unknown_correction``, with
            the nearest ids).
    """
    name = str(path)
    if Path(name).is_dir():
        raise InputError(f"{name} is a folder, expected a CDL file", code="bad_cdl", path=name)
    if not Path(name).is_file():
        raise InputError(f"there is no CDL file {name}", code="bad_cdl", path=name)
    decisions = _decisions(name, file_stamp(name))
    for own_id, cdl in decisions:
        if correction in ("", own_id):
            return cdl
    if correction.isdecimal() and int(correction) < len(decisions):
        return decisions[int(correction)][1]
    ids = [own_id or str(i) for i, (own_id, _) in enumerate(decisions)]
    raise InputError(
        f"CDL file {name} has no correction '{correction}': {hint(correction, ids)}",
        code="unknown_correction",
        path=name,
    )


@lru_cache(maxsize=64)
def _decisions(name: str, stamp: tuple[int, int]) -> tuple[tuple[str, Cdl], ...]:
    """All corrections of a file with their ids; the stamp makes a file that was edited be read again."""
    del stamp
    PyOpenColorIO.ClearAllCaches()  # OpenColorIO caches files without a limit
    try:
        found = [
            (
                str(own.getID()),
                Cdl(_three(own.getSlope()), _three(own.getOffset()), _three(own.getPower()), own.getSat()),
            )
            for own in PyOpenColorIO.CDLTransform.CreateGroupFromFile(name)
        ]
    except (*OCIO_ERRORS, SettingsError) as error:
        # OpenColorIO tries all formats; the last error is that of the format of the file's suffix.
        reason = " ".join(str(error).split()).rpartition("failed with: ")[2]
        raise InputError(f"CDL file {name} is damaged: {reason}", code="bad_cdl", path=name) from error
    if not found:
        raise InputError(f"CDL file {name} holds no correction", code="bad_cdl", path=name)
    return tuple(found)


def _three(numbers: list[float]) -> Triple:
    red, green, blue = map(float, numbers)
    return (red, green, blue)
