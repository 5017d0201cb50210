"""Openings and obscurations of a lens's surfaces, from LensAPI's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, cast

from render.model.lens import Outline
from render.optics.prescription.outlines import polygon
from render.stage.camera.lens_rows import row_error, row_values
from usd_schemas import Prescription as PrescriptionData

_SHAPES = ("ellipse", "rectangle", "polygon")
_LEAST_CORNERS = 3


def outlines(
    rows: PrescriptionData, name: Literal["opening", "obscuration"], count: int, camera: str
) -> list[Outline | None]:
    """Outline of each surface, or None.

    Args:
        rows: LensAPI's arrays.
        name: which outlines.
        count: number of surfaces.
        camera: prim path, for messages.

    Raises:
        CameraError: an array has another length than the surfaces, or there is no such shape.
    """
    shapes, sizes, centres = (
        list(row_values(rows, f"{name}_{part}", count, camera)) for part in ("shape", "size", "centre")
    )
    if (sizes or centres) and not shapes:
        raise row_error(rows, f"{name}_shape", camera, "given with sizes or centres", "none")
    polygons = _polygons(rows, name, camera)
    if shapes.count("polygon") != len(polygons):
        expected = f'{shapes.count("polygon")} polygons, one for each shape that is "polygon"'
        raise row_error(rows, f"{name}_corners", camera, expected, f"{len(polygons)}")
    if set(shapes) - {"", "polygon"} and not sizes:
        raise row_error(rows, f"{name}_size", camera, "given with shapes", "none")
    found: list[Outline | None] = []
    for i, shape in enumerate(shapes):
        if shape not in ("", *_SHAPES):
            wanted = ", ".join(f'"{each}"' for each in _SHAPES)
            raise row_error(rows, f"{name}_shape", camera, f'{wanted} or ""', f'"{shape[:40]}"')
        if shape == "polygon":
            found.append(polygons.pop(0))
            continue
        wide, high = sizes[i] if sizes else (0.0, 0.0)
        centre = tuple(centres[i]) if centres else (0.0, 0.0)
        kind = cast(Literal["ellipse", "rectangle"], shape)
        found.append(Outline(kind, (wide / 2, high / 2), cast(tuple[float, float], centre)) if shape else None)
    return found or [None] * count


def _polygons(rows: PrescriptionData, name: str, camera: str) -> list[Outline]:
    """The polygons of an array of corners: each ends where its first corner is repeated."""
    corners: Sequence[tuple[float, float]] = getattr(rows, f"{name}_corners")
    found: list[Outline] = []
    begun: list[tuple[float, float]] = []
    for corner in corners:
        if begun and corner == begun[0]:
            if len(begun) < _LEAST_CORNERS:
                raise row_error(
                    rows, f"{name}_corners", camera, f"at least {_LEAST_CORNERS} for each polygon", f"{len(begun)}"
                )
            found.append(polygon(begun))
            begun = []
        else:
            begun.append(corner)
    if begun:
        raise row_error(
            rows, f"{name}_corners", camera, "closed polygons, whose first corner is repeated", "an open one"
        )
    return found
