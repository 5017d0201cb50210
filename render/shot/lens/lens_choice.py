"""A lens to mount on a camera: from the library by its name, or from a file."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

from render.errors import NotFoundError
from render.model.lens import Prescription
from render.optics.lens_files import (
    LENS_FILE_SUFFIXES,
    MeasuredLens,
    is_data_sheet,
    parse_lens_file,
    parse_measured_lens,
    read_lens_file,
    read_measured_lens,
)
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.paraxial import first_order
from render.stage.camera.lens_data import lens_data, measured_lens_data
from usd_schemas import ApertureData, LensData, LibraryLens, SchemaError, library_lens


@dataclass(frozen=True)
class LensChoice:
    """A lens that can be mounted.

    Attributes:
        name: display name of the lens.
        lens: values for LensAPI.
        focal_length_mm: of the lens; None where it has none of its own. A zoom is mounted at the camera's, within its range.
        f_stop: wide open; 0 where any f-number is possible.
        aperture: the lens's own iris; None keeps the camera's.
        notes: one sentence for each value that was approximated or solved for.
    """

    name: str
    lens: LensData
    focal_length_mm: float | None = None
    f_stop: float = 0.0
    aperture: ApertureData | None = None
    notes: tuple[str, ...] = ()


THIN = LensChoice("the thin lens", LensData())
"""The ideal lens, at the focal length and f-number of the camera."""


def choose_lens(name_or_file: str, allow_unknown_glass: bool = False) -> LensChoice:
    """Read a lens: a file where the name has a lens file's suffix or a folder, else a lens of the library.

    Args:
        name_or_file: the lens.
        allow_unknown_glass: take a file's glass that no catalogue has by the index and the Abbe number beside its name.

    Raises:
        NotFoundError: the library has no such lens; the message has the nearest names.
        InputError: the file cannot be read, or has no usable lens.
    """
    if is_data_sheet(name_or_file):
        return measured_choice(read_measured_lens(name_or_file))
    if is_lens_file(name_or_file):
        return prescription_choice(read_lens_file(name_or_file, allow_unknown_glass))
    return library_choice(name_or_file)


def is_lens_file(name_or_file: str) -> bool:
    """True for the name of a file, false for a lens of the library."""
    return Path(name_or_file).suffix.lower() in LENS_FILE_SUFFIXES or os.sep in name_or_file


def library_entry(name: str) -> LibraryLens:
    """Look up a lens of the library.

    Raises:
        NotFoundError: the library has no such lens; the message has the nearest names.
    """
    try:
        return library_lens(name)
    except SchemaError as error:
        raise NotFoundError(str(error), code="no_such_lens", path=name) from error


def library_choice(name: str) -> LensChoice:
    """Choose a lens of the library.

    Raises:
        NotFoundError: the library has no such lens; the message has the nearest names.
    """
    entry = library_entry(name)
    return LensChoice(entry.lens.name, entry.lens, entry.focal_length_mm, entry.f_stop, entry.aperture)


def file_choice(data: bytes, name: str) -> LensChoice:
    """Choose the lens of a lens file in memory.

    Raises:
        InputError: it is no lens file, or has no usable lens.
    """
    if is_data_sheet(name):
        return measured_choice(parse_measured_lens(data, name))
    return prescription_choice(parse_lens_file(data, name))


def measured_choice(lens: MeasuredLens) -> LensChoice:
    """Choose a lens by its data sheet."""
    return LensChoice(lens.name, measured_lens_data(lens), lens.focal_length_mm, lens.f_stops[0], None, lens.sources)


def prescription_choice(prescription: Prescription) -> LensChoice:
    """Choose the lens of a prescription. It is checked with its missing values solved, and authored without them.

    Raises:
        InputError: no light comes through it to a film; the message names the surface.
    """
    whole = complete_prescription(prescription)
    return LensChoice(
        prescription.name,
        lens_data(prescription),
        round(first_order(whole).focal_length_mm, 3),
        # Wide open is where the file's own rounding ends: 2.0, and not 1.998.
        round(whole.f_stop, 2),
        None,
        whole.notes,
    )
