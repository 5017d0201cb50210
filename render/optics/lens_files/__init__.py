"""Prescriptions from the files that people have lenses in: pbrt and ISET `.dat`, Zemax `.zmx`, CODE V `.seq`, Optical Bench
`.txt`, rayoptics `.roa`, optiland `.json`; and data sheets from `.lens` files.

Readers return the file's own values: `render.optics.prescription.completion.complete_prescription` computes missing ones.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files.data_sheet import SUFFIX, MeasuredLens, data_sheet_text, read_data_sheet
from render.optics.lens_files.lens_text import MAX_BYTES, UNKNOWN_GLASS, LensText, decode

if TYPE_CHECKING:
    from render.optics.lens_files.file_glasses import FileGlasses

Reader = Callable[[LensText, "FileGlasses"], Prescription]

LENS_FILE_SUFFIXES = (".dat", ".zmx", ".seq", ".txt", ".roa", ".json", SUFFIX)
_BY_SUFFIX = {".dat": "pbrt", ".zmx": "zemax", ".seq": "code_v", ".roa": "rayoptics"}
_JSON_BY_KEY = {'"surface_group"': "optiland", '"optical_model"': "rayoptics"}
_OSLO = re.compile(r"^[ \t]*NXT\b", re.MULTILINE)
_BY_CONTENT = (
    (r"^[ \t]*\[lens data\]", "optical_bench"),
    (r"^[ \t]*SURF[ \t]+\d+[ \t]*$", "zemax"),
    (r"^[ \t]*(RDM|LEN|SO)\b", "code_v"),
    (r"^[ \t]*([-+.\deE]+[ \t]+){3}[-+.\deE]+[ \t]*(#.*)?$", "pbrt"),
)


def read_lens_file(path: str | Path, allow_unknown_glass: bool = False) -> Prescription:
    """Read the lens of a file. Its format follows from the suffix, else from the content.

    Args:
        path: of a .dat, .zmx, .seq, Optical Bench .txt, .roa or optiland .json file. Glass catalogues (.agf) in its folder win
            over the makers'.
        allow_unknown_glass: take glass that no catalogue has by the index and the Abbe number beside its name.

    Raises:
        InputError: the file is missing, not a lens file, cut off, or has unsupported features; the message names file,
            line and surface. The code of a glass that no catalogue has is ``unknown_glass``.
    """
    path = Path(path)
    return parse_lens_file(_content(path), path.name, path.parent, allow_unknown_glass)


def read_measured_lens(path: str | Path) -> MeasuredLens:
    """The lens of a `.lens` file.

    Raises:
        InputError: the file is missing, or not a data sheet; the message names file and line.
    """
    return parse_measured_lens(_content(path), Path(path).name)


def parse_measured_lens(data: bytes, name: str) -> MeasuredLens:
    """The lens of a `.lens` file that is in memory.

    Args:
        data: all of the file.
        name: of the file, for messages.

    Raises:
        InputError: as `read_measured_lens`.
    """
    return read_data_sheet(decode(data, name))


def is_data_sheet(name: str | Path) -> bool:
    """Whether a file is a lens by its data sheet and not by its surfaces, by its suffix."""
    return Path(name).suffix.lower() == SUFFIX


def _content(path: str | Path) -> bytes:
    path = Path(path)
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise ValueError("it is no file with an end, such as a pipe or a device")
        with path.open("rb") as file:
            return file.read(MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        why = getattr(error, "strerror", None) or error
        raise InputError(f"lens file {path} cannot be read: {why}", code="bad_lens_file", path=str(path)) from error


def parse_lens_file(
    data: bytes, name: str, folder: Path | None = None, allow_unknown_glass: bool = False
) -> Prescription:
    """The lens of a file that is in memory.

    Args:
        data: all of the file.
        name: name of the file; its suffix selects the format.
        folder: where glass catalogues (.agf) are looked for; None for none.
        allow_unknown_glass: as in `read_lens_file`.

    Raises:
        InputError: as `read_lens_file`.
    """
    from render.optics.lens_files.file_glasses import FileGlasses

    text = decode(data, name)
    glasses = FileGlasses(text, folder, allow_unknown_glass)
    lens = _reader(_format_of(text))(text, glasses)
    return replace(lens, notes=(*lens.notes, *glasses.notes))


def _reader(name: str) -> Reader:
    """Import the reader of a format: together they take a while, and most processes read no lens file."""
    if name == "pbrt":
        from render.optics.lens_files.pbrt import read_pbrt

        return lambda text, _: read_pbrt(text)
    if name == "zemax":
        from render.optics.lens_files.zemax import read_zemax as read
    elif name == "code_v":
        from render.optics.lens_files.code_v import read_code_v as read
    elif name == "rayoptics":
        from render.optics.lens_files.rayoptics import read_rayoptics as read
    elif name == "optiland":
        from render.optics.lens_files.optiland import read_optiland as read
    else:
        from render.optics.lens_files.optical_bench import read_optical_bench as read
    return read


def _format_of(text: LensText) -> str:
    suffix = Path(text.name).suffix.lower()
    if suffix in _BY_SUFFIX:
        return _BY_SUFFIX[suffix]
    content = "\n".join(text.lines)
    if content.lstrip().startswith("{"):
        for key, name in _JSON_BY_KEY.items():
            if key in content:
                return name
    if _OSLO.search(content):
        raise text.error("it is a lens of OSLO, whose .len files are not read: expected one that it exports for Zemax")
    for pattern, name in _BY_CONTENT:
        if re.search(pattern, content, re.MULTILINE | re.IGNORECASE):
            return name
    expected = (
        "pbrt's .dat, Zemax's .zmx, CODE V's .seq, Optical Bench's .txt, rayoptics' .roa, optiland's .json "
        "or a data sheet's .lens"
    )
    raise InputError(
        f"{text.name} is no lens file that is known: expected {expected}", code="bad_lens_file", path=text.name
    )


__all__ = [
    "LENS_FILE_SUFFIXES",
    "UNKNOWN_GLASS",
    "MeasuredLens",
    "data_sheet_text",
    "is_data_sheet",
    "parse_lens_file",
    "parse_measured_lens",
    "read_lens_file",
    "read_measured_lens",
]
