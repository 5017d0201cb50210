"""The library of camera bodies and film formats that ships with the schemas: libraries/bodies.usda, as typed Python."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

from pxr import Usd, UsdGeom

from usd_schemas import binding
from usd_schemas.applying import applied
from usd_schemas.errors import SchemaError
from usd_schemas.lookup import hint
from usd_schemas.registration import FOLDER
from usd_schemas.units import mm_from_tenths, tenths_from_mm
from usd_schemas.view import LensCamera

BODY_LIBRARY_FILE = FOLDER / "libraries" / "bodies.usda"


@dataclass(frozen=True)
class LibraryBody:
    """One camera body, or the gate of a film format.

    Attributes:
        name: on the command line and over REST, such as ``super35_4perf``.
        title: what people call it; ``film:body`` of a camera that has it.
        description: one line.
        kind: what is behind the gate.
        gate_mm: width and height of what is exposed, on the film or sensor.
        resolution: photosites across and up; (0, 0) for film.
        squeeze: of the anamorphic lenses that it is made for; 1 for none.
    """

    name: str
    title: str
    description: str
    kind: Literal["film", "digital"]
    gate_mm: tuple[float, float]
    resolution: tuple[int, int]
    squeeze: float


def body_names() -> list[str]:
    """Names of all bodies, in the library's order."""
    return list(_library())


def library_bodies() -> list[LibraryBody]:
    """All bodies, in the library's order."""
    return list(_library().values())


def library_body(name: str) -> LibraryBody:
    """The body of that name.

    Args:
        name: as `body_names` has it, or its title; small and capital letters, and ``-`` or a space for ``_``, are the same.

    Raises:
        SchemaError: there is none; the message has the nearest names.
    """
    bodies, plain = _library(), _plain(name)
    for body in bodies.values():
        if plain in (body.name, _plain(body.title)):
            return body
    raise SchemaError(f"there is no camera body named {name!r} in the library: {hint(plain, bodies)}")


def mount_body(camera: LensCamera, body: LibraryBody) -> None:
    """Give a camera another body, in the stage's edit target and for all time: its gate, its photosites and its name.

    The lens stays, and the focal length with it, so the field of view changes. How far the picture is stretched back is the
    lens's matter too: the aperture becomes as wide as ``lens:squeeze`` makes the gate, whatever lenses the body is made for.

    Args:
        camera: the camera.
        body: of the library.

    Raises:
        SchemaError: a value is not allowed.
    """
    stage = camera.prim.GetStage()
    width, height = body.gate_mm[0] * camera.lens.read().squeeze, body.gate_mm[1]
    with applied(camera.prim, "FilmAPI"):
        for name, value in (
            ("horizontalAperture", tenths_from_mm(width, stage)),
            ("verticalAperture", tenths_from_mm(height, stage)),
            ("film:body", body.title),
            ("film:resolution", body.resolution),
        ):
            binding.author_for_all_time(camera.prim.GetAttribute(name), value)


def _plain(name: str) -> str:
    return name.strip().lower().replace("-", "_").replace(" ", "_")


@cache
def _library() -> dict[str, LibraryBody]:
    stage = Usd.Stage.Open(str(BODY_LIBRARY_FILE))
    return {prim.GetName(): _body(prim) for prim in stage.GetDefaultPrim().GetChildren()}


def _body(prim: Usd.Prim) -> LibraryBody:
    camera, usd, stage = LensCamera(prim), UsdGeom.Camera(prim), prim.GetStage()
    film, squeeze = camera.film.read(), camera.lens.read().squeeze

    def mm(attribute: Usd.Attribute) -> float:  # to single precision's last digit: the attribute is a float
        return round(mm_from_tenths(float(attribute.Get()), stage), 4)

    return LibraryBody(
        name=prim.GetName(),
        title=film.body,
        description=prim.GetDocumentation(),
        kind="digital" if film.process == "digital" else "film",
        gate_mm=(round(mm(usd.GetHorizontalApertureAttr()) / squeeze, 4), mm(usd.GetVerticalApertureAttr())),
        resolution=film.resolution,
        squeeze=squeeze,
    )
