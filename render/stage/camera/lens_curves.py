"""Curves of a lens's surfaces from side to side, from LensAPI's arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, cast

from render.model.lens import Across
from render.stage.camera.lens_rows import row_error, row_values
from usd_schemas import Prescription as PrescriptionData

_TORI = ("", "upright", "across")


def curves_across(
    rows: PrescriptionData, radii_mm: Sequence[float], conics: Sequence[float], camera: str
) -> list[Across | None]:
    """Curve from side to side of each surface, None where it is that from top to bottom.

    Args:
        rows: LensAPI's arrays.
        radii_mm: from top to bottom.
        conics: from top to bottom.
        camera: prim path, for messages.

    Raises:
        CameraError: an array has another length than the surfaces, or there is no such torus.
    """
    count = len(radii_mm)
    across = row_values(rows, "radius_across", count, camera) or radii_mm
    across_conics = row_values(rows, "conic_across", count, camera)
    tori = row_values(rows, "torus", count, camera) or ("",) * count
    found: list[Across | None] = []
    for i, (torus, radius) in enumerate(zip(tori, across, strict=True)):
        if torus not in _TORI:
            raise row_error(rows, "torus", camera, '"upright", "across" or ""', f'"{torus[:40]}"')
        conic = across_conics[i] if across_conics else 0.0 if torus else conics[i]
        made = Across(radius, conic, cast(Literal["", "upright", "across"], torus))
        found.append(None if made == Across(radii_mm[i], conics[i]) else made)
    return found
