"""Openings and obscurations of a lens's surfaces, from LensAPI's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, cast

from render.errors import CameraError
from render.model.lens import Outline
from usd_schemas import Prescription as PrescriptionData

_SHAPES = ("ellipse", "rectangle")


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
    shapes, sizes, centres = (_array(rows, f"{name}_{part}", count, camera) for part in ("shape", "size", "centre"))
    if (sizes or centres) and not shapes:
        raise _error(rows, f"{name}_shape", camera, "given with sizes or centres", "none")
    if shapes and not sizes:
        raise _error(rows, f"{name}_size", camera, "given with shapes", "none")
    found: list[Outline | None] = []
    for i, shape in enumerate(shapes):
        if shape not in ("", *_SHAPES):
            wanted = ", ".join(f'"{each}"' for each in _SHAPES)
            raise _error(rows, f"{name}_shape", camera, f'{wanted} or ""', f'"{shape[:40]}"')
        wide, high = sizes[i]
        centre = tuple(centres[i]) if centres else (0.0, 0.0)
        kind = cast(Literal["ellipse", "rectangle"], shape)
        found.append(Outline(kind, (wide / 2, high / 2), cast(tuple[float, float], centre)) if shape else None)
    return found or [None] * count


def _array(rows: PrescriptionData, field: str, count: int, camera: str) -> Sequence[Any]:
    values: Sequence[Any] = getattr(rows, field)
    if len(values) not in (0, count):
        raise _error(rows, field, camera, f"{count} entries, like lens:prescription:radius", f"{len(values)}")
    return values


def _error(rows: PrescriptionData, field: str, camera: str, expected: str, got: str) -> CameraError:
    name = rows.__dataclass_fields__[field].metadata["usd"]
    return CameraError(f"{name} of camera {camera} must be {expected}, got {got}", path=camera)
