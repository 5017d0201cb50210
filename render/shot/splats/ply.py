"""Splats of a .ply file as Kerbl et al. 2023 ("3D Gaussian Splatting") write them, and most programs after them.

One element ``vertex`` with the properties ``x y z``, ``f_dc_0`` to ``f_dc_2`` and ``f_rest_0`` on (spherical harmonics, red's
before green's before blue's), ``opacity`` before a logistic function, ``scale_0`` to ``scale_2`` as logarithms and ``rot_0`` to
``rot_3`` (a quaternion, real part first). Other properties, such as normals, are passed over. The file is binary or text.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

import numpy as np

from render.errors import InputError
from render.model.arrays import BoolArray, FloatArray
from render.model.splats import MAX_SPLATS

_TYPES = {
    "char": "i1",
    "int8": "i1",
    "uchar": "u1",
    "uint8": "u1",
    "short": "i2",
    "int16": "i2",
    "ushort": "u2",
    "uint16": "u2",
    "int": "i4",
    "int32": "i4",
    "uint": "u4",
    "uint32": "u4",
    "float": "f4",
    "float32": "f4",
    "double": "f8",
    "float64": "f8",
}
_FORMATS = {"binary_little_endian": "<", "binary_big_endian": ">", "ascii": "<"}
_MOST_HEADER_BYTES = 1 << 16
_MOST_PROPERTIES = 256
_REST = {0: 0, 9: 1, 24: 2, 45: 3}
"""Degree of the spherical harmonics by the number of properties ``f_rest``."""
_NEEDED = (
    *("x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity"),
    *("scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"),
)


@dataclass(frozen=True, eq=False)
class CapturedSplats:
    """Splats of a file, in its own space and units.

    Attributes:
        positions: ``(n, 3)``.
        scales: ``(n, 3)`` standard deviations along the axes.
        orientations: ``(n, 4)`` unit quaternions, real part first.
        opacities: ``(n,)`` 0 to 1.
        harmonics: ``(n, k, 3)`` coefficients of red, green and blue.
        degree: of the spherical harmonics, 0 to 3.
        unusable: number of splats of the file that were left out, since their numbers are not finite.
    """

    positions: FloatArray
    scales: FloatArray
    orientations: FloatArray
    opacities: FloatArray
    harmonics: FloatArray
    degree: int
    unusable: int


@dataclass(frozen=True)
class _Header:
    count: int
    names: tuple[str, ...]
    record: np.dtype[np.void]
    is_text: bool


def read_ply(path: Path) -> CapturedSplats:
    """Read the splats of a .ply file.

    Args:
        path: the file.

    Raises:
        InputError: it is missing, no .ply file of Gaussian splats, damaged or too large.
    """
    try:
        status = os.stat(path)
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"{path} is no file of splats: it is a folder or a device", path=str(path))
        with path.open("rb") as file:
            header = _read_header(file, path)
            rows = _read_rows(file, header, status.st_size, path)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{path} cannot be read: {reason}", path=str(path)) from error
    return _convert(rows, header, path)


def _read_header(file: BufferedReader, path: Path) -> _Header:
    """Read the header up to its end; only the first element counts, and it must be ``vertex``."""
    if file.readline(8).rstrip(b"\r\n") != b"ply":
        raise _bad(path, "its first line must be 'ply'")
    form, count, element, left = "", -1, 0, _MOST_HEADER_BYTES
    properties: dict[str, str] = {}
    while True:
        line = file.readline(left)
        left -= len(line)
        if not line.endswith(b"\n") or left <= 0:
            raise _bad(path, "its header has no end")
        words = line.decode("ascii", "replace").split()
        match words:
            case [] | ["comment", *_] | ["obj_info", *_]:
                continue
            case ["end_header"]:
                break
            case ["format", name, "1.0"] if name in _FORMATS and not form:
                form = name
            case ["element", name, number] if number.isdecimal() and len(number) < 20:
                element += 1
                if element == 1:
                    if name != "vertex":
                        raise _bad(path, f"its first element must be 'vertex', got {name!r}")
                    count = int(number)
            case ["property", kind, name] if kind in _TYPES and element > 0:
                if element == 1:
                    if name in properties or len(properties) >= _MOST_PROPERTIES:
                        raise _bad(path, f"it has too many properties, or two of the name {name!r}")
                    properties[name] = _TYPES[kind]
            case ["property", "list", *_] if element > 1:
                continue
            case _:
                raise _bad(path, f"its header has a line that is not understood: {' '.join(words)[:60]!r}")
    if not form:
        raise _bad(path, "its header has no line 'format'")
    return _checked(_FORMATS[form], form == "ascii", count, properties, path)


def _checked(order: str, is_text: bool, count: int, properties: Mapping[str, str], path: Path) -> _Header:
    missing = [name for name in _NEEDED if name not in properties]
    if missing:
        raise _bad(path, f"it holds no Gaussian splats: properties {', '.join(missing[:4])} are missing")
    if not 0 < count <= MAX_SPLATS:
        raise _bad(path, f"it must have 1 to {MAX_SPLATS:,} splats, got {count:,}")
    rest = sum(name.startswith("f_rest_") for name in properties)
    if rest not in _REST or not all(f"f_rest_{number}" in properties for number in range(rest)):
        raise _bad(path, f"it must have properties f_rest_0 on, 0, 9, 24 or 45 in number, got {rest}")
    record = np.dtype([(name, order + kind) for name, kind in properties.items()])
    return _Header(count, tuple(properties), record, is_text)


def _read_rows(
    file: BufferedReader, header: _Header, size: int, path: Path
) -> np.ndarray[tuple[int, ...], np.dtype[np.void]]:
    """Values of all splats, ``(n,)`` records."""
    if not header.is_text:
        held = (size - file.tell()) // header.record.itemsize
        if held < header.count:
            raise _bad(path, f"it ends after {max(0, held):,} of its {header.count:,} splats")
        return np.fromfile(file, header.record, header.count)
    if size - file.tell() < 2 * len(header.names) * header.count - 1:
        raise _bad(path, f"it is too short for {header.count:,} splats")
    values = np.loadtxt(file, np.float64, max_rows=header.count, ndmin=2, comments=None)
    if values.shape != (header.count, len(header.names)):
        raise _bad(path, f"it must have {header.count:,} lines of {len(header.names)} numbers, got {values.shape[0]:,}")
    rows = np.zeros(header.count, [(name, "f8") for name in header.names])
    for column, name in zip(values.T, header.names, strict=True):
        rows[name] = column
    return rows


def _convert(rows: np.ndarray[tuple[int, ...], np.dtype[np.void]], header: _Header, path: Path) -> CapturedSplats:
    """Splats of the file's own logarithms, logits and order of coefficients."""
    with np.errstate(all="ignore"):

        def columns(*names: str) -> FloatArray:
            return np.stack([rows[name].astype(np.float32) for name in names], axis=1)

        rest = sum(name.startswith("f_rest_") for name in header.names)
        harmonics = columns("f_dc_0", "f_dc_1", "f_dc_2")[:, None]
        if rest:
            more = columns(*(f"f_rest_{number}" for number in range(rest))).reshape(len(rows), 3, rest // 3)
            harmonics = np.concatenate([harmonics, more.transpose(0, 2, 1)], axis=1)
        positions, scales = columns("x", "y", "z"), np.exp(columns("scale_0", "scale_1", "scale_2"))
        turns = columns("rot_0", "rot_1", "rot_2", "rot_3")
        turns = turns / np.linalg.norm(turns, axis=1, keepdims=True)
        opacities = 1 / (1 + np.exp(-rows["opacity"].astype(np.float32)))
    usable: BoolArray = np.isfinite(opacities) & np.isfinite(harmonics).all(axis=(1, 2))
    for values in (positions, scales, turns):
        usable &= np.isfinite(values).all(axis=1)
    if not usable.any():
        raise _bad(path, "none of its splats has finite numbers")
    return CapturedSplats(
        positions[usable],
        np.asarray(scales[usable], np.float32),
        np.asarray(turns[usable], np.float32),
        np.asarray(opacities[usable], np.float32),
        harmonics[usable],
        degree=_REST[rest],
        unusable=len(rows) - int(usable.sum()),
    )


def _bad(path: Path, fault: str) -> InputError:
    return InputError(f"{path} is no .ply file of splats that can be read: {fault}", code="bad_splats", path=str(path))
