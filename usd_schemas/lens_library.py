"""The lens library that ships with the schemas: libraries/lenses.usda, as typed Python."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

from pxr import UsdGeom

from usd_schemas.errors import SchemaError
from usd_schemas.library_prims import library_prims
from usd_schemas.lookup import hint
from usd_schemas.registration import FOLDER
from usd_schemas.settings import ApertureData, LensData
from usd_schemas.units import mm_from_tenths
from usd_schemas.view import LensCamera

LIBRARY_FILE = FOLDER / "libraries" / "lenses.usda"


@dataclass(frozen=True)
class StatedNumbers:
    """Numbers that a lens's source states of it, at the size that it has in the library.

    Attributes:
        focal_length_mm: in millimetres.
        f_stop: wide open.
        field_deg: full angle of the field, in degrees; None where the source has none.
    """

    focal_length_mm: float
    f_stop: float
    field_deg: float | None = None


@dataclass(frozen=True)
class LibraryLens:
    """One lens of the library.

    Attributes:
        name: on the command line and over REST, such as ``planar_50``.
        description: one line.
        focal_length_mm: of the lens; of a zoom, where it is mounted.
        f_stop: wide open; 0 for a pinhole.
        lens: what LensAPI says of it.
        aperture: what ApertureAPI says of its iris; None where any iris goes with it.
        families: what it is and how it draws, in words of `usd_schemas.lens_search.FAMILIES`.
        source: whence its numbers are.
        year: in which its patent was granted or laid open, else of the publication; None for lenses of our own.
        stated: what the source states of it; None for lenses that no source has.
    """

    name: str
    description: str
    focal_length_mm: float
    f_stop: float
    lens: LensData
    aperture: ApertureData | None = None
    families: tuple[str, ...] = ()
    source: str = ""
    year: int | None = None
    stated: StatedNumbers | None = None

    @property
    def focal_length_range_mm(self) -> tuple[float, float] | None:
        """Shortest and longest focal length of a zoom; None for a lens without zoom."""
        return zoom_range_mm(self.lens)


def zoom_range_mm(lens: LensData) -> tuple[float, float] | None:
    """Shortest and longest focal length that a lens's configurations state; None where they state one alone or none."""
    positions = lens.configurations
    near = positions.object_distance or (0.0,) * len(positions.focal_length)
    stated = [
        focal for focal, distance in zip(positions.focal_length, near, strict=False) if distance == 0 and focal > 0
    ]
    return (min(stated), max(stated)) if stated and min(stated) < max(stated) else None


def lens_names() -> list[str]:
    """Names of all lenses, in the library's order."""
    return list(library_prims(LIBRARY_FILE))


def library_lenses() -> list[LibraryLens]:
    """All lenses, in the library's order."""
    return [_lens(name) for name in library_prims(LIBRARY_FILE)]


def library_lens(name: str) -> LibraryLens:
    """The lens of that name.

    Args:
        name: as `lens_names` has it; small and capital letters, and ``-`` for ``_``, are the same.

    Raises:
        SchemaError: there is none; the message has the nearest names.
    """
    plain = name.lower().replace("-", "_")
    names = lens_names()
    if plain not in names:
        raise SchemaError(f"there is no lens named {name!r} in the library: {hint(plain, names)}")
    return _lens(plain)


@cache
def _lens(name: str) -> LibraryLens:
    """Read one lens: all of them take a while."""
    prim = library_prims(LIBRARY_FILE)[name]
    camera, usd, data = LensCamera(prim), UsdGeom.Camera(prim), prim.GetCustomData()
    return LibraryLens(
        name=name,
        description=prim.GetDocumentation(),
        # To single precision's last digit: the attribute is a float.
        focal_length_mm=round(mm_from_tenths(float(usd.GetFocalLengthAttr().Get()), prim.GetStage()), 4),
        f_stop=round(float(usd.GetFStopAttr().Get()), 4),
        lens=camera.lens.read(),
        aperture=camera.aperture.read() if camera.aperture.applied else None,
        families=tuple(data.get("families", ())),
        source=data.get("source", ""),
        year=data.get("year"),
        stated=_stated(data),
    )


def _stated(data: Mapping[str, Any]) -> StatedNumbers | None:
    if "statedFocalLength" not in data:
        return None
    return StatedNumbers(data["statedFocalLength"], data["statedFStop"], data.get("statedField"))
