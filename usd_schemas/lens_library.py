"""The lens library that ships with the schemas: libraries/lenses.usda, as typed Python."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from pxr import Usd, UsdGeom

from usd_schemas.errors import SchemaError
from usd_schemas.lookup import hint
from usd_schemas.registration import FOLDER
from usd_schemas.settings import ApertureData, LensData
from usd_schemas.units import mm_from_tenths
from usd_schemas.view import LensCamera

LIBRARY_FILE = FOLDER / "libraries" / "lenses.usda"


@dataclass(frozen=True)
class LibraryLens:
    """One lens of the library.

    Attributes:
        name: on the command line and over REST, such as ``planar_50``.
        description: one line.
        focal_length_mm: of the lens.
        f_stop: wide open; 0 for a pinhole.
        lens: what LensAPI says of it.
        aperture: what ApertureAPI says of its iris; None where any iris goes with it.
    """

    name: str
    description: str
    focal_length_mm: float
    f_stop: float
    lens: LensData
    aperture: ApertureData | None = None


def lens_names() -> list[str]:
    """Names of all lenses, in the library's order."""
    return list(_library())


def library_lenses() -> list[LibraryLens]:
    """All lenses, in the library's order."""
    return list(_library().values())


def library_lens(name: str) -> LibraryLens:
    """The lens of that name.

    Args:
        name: as `lens_names` has it; small and capital letters, and ``-`` for ``_``, are the same.

    Raises:
        SchemaError: there is none; the message has the nearest names.
    """
    plain = name.lower().replace("-", "_")
    lenses = _library()
    if plain not in lenses:
        raise SchemaError(f"there is no lens named {name!r} in the library: {hint(plain, lenses)}")
    return lenses[plain]


@cache
def _library() -> dict[str, LibraryLens]:
    stage = Usd.Stage.Open(str(LIBRARY_FILE))
    return {prim.GetName(): _lens(prim) for prim in stage.GetDefaultPrim().GetChildren()}


def _lens(prim: Usd.Prim) -> LibraryLens:
    camera, usd = LensCamera(prim), UsdGeom.Camera(prim)
    return LibraryLens(
        name=prim.GetName(),
        description=prim.GetDocumentation(),
        # To single precision's last digit: the attribute is a float.
        focal_length_mm=round(mm_from_tenths(float(usd.GetFocalLengthAttr().Get()), prim.GetStage()), 4),
        f_stop=round(float(usd.GetFStopAttr().Get()), 4),
        lens=camera.lens.read(),
        aperture=camera.aperture.read() if camera.aperture.applied else None,
    )
