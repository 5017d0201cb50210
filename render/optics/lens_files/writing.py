"""Lens files of a prescription: Zemax `.zmx`, CODE V `.seq`, Optical Bench `.txt`. To be read again gives the same lens."""

from __future__ import annotations

from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path

from render.errors import SettingsError
from render.model.lens import Prescription, Surface
from render.optics.lens_files.written_parts import plain_name

WRITTEN_SUFFIXES = (".zmx", ".seq", ".txt")
_WRITTEN = frozenset(  # fields of the model that the writers know
    {"radius_mm", "thickness_mm", "glass", "semi_diameter_mm", "conic", "aspheric", "is_stop", "coating_nm", "odd"}
    | {"opening", "obscuration", "across", "focus_group_across", "phase"}
    | {"surfaces", "focus_group", "f_stop", "name", "notes", "configurations"}
)


@dataclass(frozen=True)
class WrittenLens:
    """A lens file that is to be written.

    Attributes:
        content: all of its bytes.
        notes: what the format cannot say, one sentence each.
    """

    content: bytes
    notes: tuple[str, ...]


def write_lens(lens: Prescription, suffix: str) -> WrittenLens:
    """The lens file of a prescription.

    Args:
        lens: complete.
        suffix: of the file, which selects the format.

    Raises:
        SettingsError: there is no such format, or it cannot hold what the lens has; the message names the surface.
    """
    suffix = suffix.lower()
    if suffix not in WRITTEN_SUFFIXES:
        raise SettingsError(f"lens files are written as {', '.join(WRITTEN_SUFFIXES)}, got {suffix or 'no suffix'}")
    why = unwritable(lens)
    if why:
        raise SettingsError(f"{lens.name or 'the lens'} cannot be written as a lens file: {why}")
    if suffix == ".zmx":
        from render.optics.lens_files.zemax_writer import zemax_text as text_of
    elif suffix == ".seq":
        from render.optics.lens_files.code_v_writer import code_v_text as text_of
    else:
        from render.optics.lens_files.optical_bench_writer import optical_bench_text as text_of
    lens = replace(lens, name=plain_name(lens.name))
    notes: list[str] = []
    text = text_of(lens, notes)
    if lens.focus_group_across is not None:
        notes.append("The cylinders that move to focus from side to side are not written.")
    if any(surface.coating_nm for surface in lens.surfaces):
        notes.append("Coatings are not written.")
    if suffix == ".txt" and lens.outlines:
        notes.append("Openings and obscurations are not written: light passes all of the clear diameters.")
    # OpticStudio writes UTF-16; what is ASCII every program reads.
    encoding = "utf-16" if suffix == ".zmx" and not text.isascii() else "utf-8"
    return WrittenLens(text.replace("\n", "\r\n" if suffix == ".zmx" else "\n").encode(encoding), tuple(notes))


def unwritable(lens: Prescription) -> str:
    """Why a prescription cannot be written: it has what no writer knows; "" where it can."""
    parts: list[tuple[str, Prescription | Surface]] = [
        ("the lens", lens),
        *((f"surface {i + 1}", surface) for i, surface in enumerate(lens.surfaces)),
    ]
    for name, part in parts:
        for each in fields(part):
            if each.name not in _WRITTEN and getattr(part, each.name) != _default(each):
                return f"{name} has values of {each.name}"
    return ""


def _default(each: object) -> object:
    default, factory = getattr(each, "default", MISSING), getattr(each, "default_factory", MISSING)
    return factory() if callable(factory) else default


def target_suffix(path: Path) -> str:
    """Suffix of a file that is to be written.

    Raises:
        SettingsError: no lens file has it.
    """
    if path.suffix.lower() not in WRITTEN_SUFFIXES:
        raise SettingsError(f"a lens file is written as {', '.join(WRITTEN_SUFFIXES)}, got {path}")
    return path.suffix.lower()
