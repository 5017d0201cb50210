"""Lens and iris of a camera, from its schemas. The inverse is in `render.stage.camera.lens_data`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from render.errors import CameraError, SettingsError
from render.model.arrays import DoubleArray
from render.model.data_sheet import DataSheet
from render.model.lens import (
    AIR,
    AberrationScales,
    Configuration,
    Glass,
    HeightField,
    IrisShape,
    Lens,
    LensModel,
    Prescription,
    SeidelErrors,
    Surface,
)
from render.optics.channel_indices import with_channel_indices
from render.optics.dispersion.names import agreeing_glass
from render.optics.glass import D_LINE_NM, refractive_index
from render.optics.prescription.validation import MAX_CONFIGURATIONS
from render.stage.camera.lens_curves import curves_across
from render.stage.camera.lens_data import ASPHERIC, ODD, PHASE, SQUEEZES
from render.stage.camera.lens_outlines import outlines
from render.stage.camera.planes import read_plane, rotate_plane
from render.stage.camera.seidel_units import axial_color_mm, lateral_color_mm
from render.stage.materials.image_files import TextureError
from usd_schemas import ApertureData, Asset, LensData
from usd_schemas import Configurations as ConfigurationsData
from usd_schemas import Prescription as PrescriptionData
from usd_schemas import Seidel as SeidelData

_SURFACES = {"spherical": 2, "heightField": 2}


def make_lens(data: LensData, camera: str, confined_to: Path | None = None) -> Lens:
    """Make the lens of a camera.

    Args:
        data: LensAPI's values.
        camera: prim path, for messages.
        confined_to: the folder that height fields must lie in, or None.

    Raises:
        CameraError: no lens has such numbers, or a height field cannot be read.
    """
    for name, value in _numbers(data):
        if not math.isfinite(value):
            raise _error(camera, f"lens:{name}", "a finite number", f"{value}")
    least, most = SQUEEZES
    if not least <= data.squeeze <= most:
        raise _error(camera, "lens:squeeze", f"from {least:g} to {most:g}", f"{data.squeeze:g}")
    if not (0 <= data.transmittance <= 1 and data.neutral_density >= 0):
        got = f"{data.transmittance:g} and {data.neutral_density:g}"
        raise _error(camera, "lens:transmittance (0 to 1) and lens:neutralDensity (0 or more)", "in range", got)
    if not all(power > 0 for power in data.pupil_power):
        raise _error(camera, "lens:expressive:pupilPower", "above 0 everywhere", _format_values(data.pupil_power))
    widest, closed = data.f_stop_range
    if min(widest, closed) < 0 or 0 < closed < widest:
        expected = "from wide open to closed down, 0 for an end that is unknown"
        raise _error(camera, "lens:fStopRange", expected, f"{widest:g} and {closed:g}")
    if not 0 <= data.expressive_blend <= 1:
        raise _error(camera, "lens:expressive:blend", "from 0 to 1", f"{data.expressive_blend:g}")
    if not min(data.flare_ghosts, data.flare_star) >= 0:
        got = f"{data.flare_ghosts:g} and {data.flare_star:g}"
        raise _error(camera, "lens:flare:ghosts and lens:flare:star", "0 or more", got)
    model: LensModel = data.model
    surfaces = _prescription(data, camera) if model in ("prescription", *_SURFACES) else None
    return Lens(
        model=model,
        name=data.name,
        prescription=surfaces,
        seidel=_seidel(data.seidel, camera) if model == "seidel" else None,
        data_sheet=_data_sheet(data, camera) if model == "dataSheet" else None,
        height_field=_height_field(data, camera, confined_to) if model == "heightField" else None,
        scales=AberrationScales(*(getattr(data.aberration, item.name) for item in fields(AberrationScales))),
        squeeze=data.squeeze,
        transmittance=data.transmittance * 10**-data.neutral_density,
        pupil_magnification=data.pupil_magnification,
        natural_vignetting=data.natural_vignetting,
        close_focus_m=data.close_focus / 1000,
        pupil_power=data.pupil_power,
        expressive_blend=data.expressive_blend,
        ghosts=data.flare_ghosts,
        star=data.flare_star,
    )


def make_iris(data: ApertureData, camera: str, confined_to: Path | None = None) -> IrisShape:
    """Make the iris of a camera; the same numbers and files give the same object.

    Args:
        data: ApertureAPI's values.
        camera: prim path, for messages.
        confined_to: the folder that a mask must lie in, or None.

    Raises:
        CameraError: no iris has such numbers, or the mask cannot be read or lets no light through.
    """
    weights = data.radial_weights
    if weights and not (all(0 <= weight < math.inf for weight in weights) and max(weights) > 0):
        raise _error(
            camera, "aperture:radialWeights", "0 or more, and one of them above 0", f"{_format_values(weights)}"
        )
    if not math.isfinite(data.rotation):
        raise _error(camera, "aperture:rotation", "a finite number", f"{data.rotation:g}")
    mask = _plane(data.mask, "aperture:mask", camera, confined_to)
    if mask is not None and not (mask.min() >= 0 and mask.max() > 0):
        raise _error(camera, "aperture:mask", "an image of 0 or more that lets light through somewhere", data.mask.path)
    try:
        return _iris(data.blades, data.roundness, math.radians(data.rotation), _ArrayKey(mask), weights)
    except SettingsError as error:
        raise CameraError(f"aperture of camera {camera}: {error.detail}", path=camera) from error


def _prescription(data: LensData, camera: str) -> Prescription:
    rows = data.prescription
    count = len(rows.radius)
    _check_channels(data.channel_index, camera)
    wanted = _SURFACES.get(data.model)
    if count == 0 or (wanted and count != wanted):
        expected = f"{wanted or 'at least one'} entries for lens:model {data.model}"
        raise _error(camera, "lens:prescription:radius", f"an array of {expected}", f"{count}")
    columns = {field: _column(rows, field, count, camera) for field in _COLUMNS}
    glasses = [_glass(columns, i) for i in range(count)]
    if not -1 <= rows.stop_surface < count:
        raise _error(camera, "lens:prescription:stopSurface", f"from -1 to {count - 1}", f"{rows.stop_surface}")
    group, group_across = (_group(rows, field, count, camera) for field in ("focus_group", "focus_group_across"))
    across = curves_across(rows, columns["radius"], columns["conic"], camera)
    if wanted and any(across):
        raise _error(
            camera, "lens:prescription:radiusAcross", f"left out for lens:model {data.model}", "radii of cylinders"
        )
    openings, obscurations = (outlines(rows, name, count, camera) for name in ("opening", "obscuration"))
    if wanted and any((*openings, *obscurations)):
        names = "lens:prescription:openingShape and obscurationShape"
        raise _error(camera, names, f"left out for lens:model {data.model}", "shapes")
    prescription = Prescription(
        tuple(
            Surface(
                columns["radius"][i],
                columns["thickness"][i],
                glasses[i],
                columns["clear_diameter"][i] / 2,
                columns["conic"][i],
                _terms([columns[field][i] for field in ASPHERIC]),
                i == rows.stop_surface,
                columns["coating_wavelength"][i],
                across[i],
                openings[i],
                obscurations[i],
                _terms([columns[field][i] for field in ODD]),
                _terms([columns[field][i] for field in PHASE]),
            )
            for i in range(count)
        ),
        focus_group=group,
        f_stop=max(data.f_stop_range[0], 0.0),
        name=data.name or f"the lens of {camera}",
        focus_group_across=group_across,
        configurations=_configurations(data.configurations, count, camera) if data.model == "prescription" else (),
    )
    return with_channel_indices(prescription, data.channel_index) if any(data.channel_index) else prescription


def _check_channels(indices: Sequence[float], camera: str) -> None:
    if any(indices) and not all(1 < index <= 10 for index in indices):
        expected = "three numbers above 1 and up to 10, or three zeros"
        raise _error(camera, "lens:expressive:channelIndex", expected, _format_values(indices))


def _configurations(rows: ConfigurationsData, surfaces: int, camera: str) -> tuple[Configuration, ...]:
    """Positions of zoom and focus."""
    count, left = divmod(len(rows.thickness), surfaces)
    if left or count > MAX_CONFIGURATIONS:
        expected = f"{surfaces} entries for each position, of at most {MAX_CONFIGURATIONS} positions"
        raise _error(camera, "lens:configuration:thickness", expected, f"{len(rows.thickness)}")
    columns: dict[str, Sequence[float]] = {}
    for field in ("object_distance", "focal_length", "f_stop"):
        values: Sequence[float] = getattr(rows, field)
        if len(values) not in (0, count):
            name = rows.__dataclass_fields__[field].metadata["usd"]
            raise _error(camera, name, f"{count} entries, one for each position", f"{len(values)}")
        columns[field] = values or (0.0,) * count
    return tuple(
        Configuration(
            tuple(rows.thickness[i * surfaces : (i + 1) * surfaces]),
            columns["object_distance"][i] or math.inf,
            columns["focal_length"][i],
            columns["f_stop"][i],
        )
        for i in range(count)
    )


def _group(rows: PrescriptionData, field: str, count: int, camera: str) -> tuple[int, int] | None:
    """A group of surfaces, None for (-1, -1)."""
    first, last = getattr(rows, field)
    if (first, last) == (-1, -1):
        return None
    if not 0 <= first <= last < count:
        name = rows.__dataclass_fields__[field].metadata["usd"]
        raise _error(camera, name, f"(-1, -1), or rising from 0 to {count - 1}", f"({first}, {last})")
    return first, last


_NOTHING: dict[str, Any] = {
    "sellmeier_b": (0.0, 0.0, 0.0),
    "sellmeier_c": (0.0, 0.0, 0.0),
    "glass": "",
    "index": 1.0,
}
_COLUMNS = (
    "radius",
    "thickness",
    "abbe",
    "clear_diameter",
    "conic",
    "coating_wavelength",
    *_NOTHING,
    *ASPHERIC,
    *ODD,
    *PHASE,
)


def _column(rows: PrescriptionData, field: str, count: int, camera: str) -> Sequence[Any]:
    """Column with one value for each surface, or none where the array is missing."""
    values: Sequence[Any] = getattr(rows, field)
    if values and len(values) != count:
        name = rows.__dataclass_fields__[field].metadata["usd"]
        raise _error(camera, name, f"{count} entries, like lens:prescription:radius", f"{len(values)}")
    return values or [_NOTHING.get(field, 0.0)] * count


def _glass(columns: dict[str, Sequence[Any]], i: int) -> Glass:
    name, index, abbe, b, c = (columns[field][i] for field in ("glass", "index", "abbe", "sellmeier_b", "sellmeier_c"))
    if not any(b):
        if index == 1 and abbe == 0:
            return AIR
        return agreeing_glass(name, index, abbe) or Glass(index, abbe, name=name)
    glass = Glass(index, abbe, tuple(b), tuple(c), name)
    # Sellmeier's equation wins; the number is used where only the index at the d line is needed.
    return Glass(refractive_index(glass, D_LINE_NM), abbe, glass.sellmeier_b, glass.sellmeier_c, glass.name)


def _terms(values: list[float]) -> tuple[float, ...]:
    """Terms without trailing zeros."""
    while values and values[-1] == 0:
        values.pop()
    return tuple(values)


def _seidel(data: SeidelData, camera: str) -> SeidelErrors:
    if not (data.reference_f_stop > 0 and data.reference_height > 0):
        got = f"{data.reference_f_stop:g} and {data.reference_height:g}"
        raise _error(camera, "lens:seidel:referenceFStop and referenceHeight", "above 0", got)
    return SeidelErrors(
        w040=data.w040,
        w131=data.w131,
        w222=data.w222,
        w220=data.w220,
        w311=data.w311,
        axial_color_mm=axial_color_mm(data.axial_color, data.reference_f_stop),
        lateral_color_mm=lateral_color_mm(data.lateral_color, data.reference_f_stop),
        reference_f_stop=data.reference_f_stop,
        reference_height_mm=data.reference_height,
    )


def _data_sheet(data: LensData, camera: str) -> DataSheet:
    table = data.data_sheet
    try:
        return DataSheet(
            heights_mm=table.height,
            distortion=table.distortion,
            light=table.vignetting,
            sagittal_blur_mm=table.sagittal_blur,
            tangential_blur_mm=table.tangential_blur,
            spherical=table.spherical_aberration,
            coma_mm=table.coma,
            field_curvature_mm=table.field_curvature,
            lateral_color_mm=table.lateral_color,
            axial_color_mm=table.axial_color,
            f_stop=table.f_stop or max(data.f_stop_range[0], 0.0),
        )
    except SettingsError as error:
        raise CameraError(f"lens:table of camera {camera}: {error.detail}", path=camera) from error


def _height_field(data: LensData, camera: str, confined_to: Path | None) -> HeightField:
    front = _plane(data.height_field.front, "lens:heightField:front", camera, confined_to)
    back = _plane(data.height_field.back, "lens:heightField:back", camera, confined_to)
    return _scaled_heights(_ArrayKey(front), _ArrayKey(back), tuple(data.height_field.scale))


class _ArrayKey:
    """Array as a cache key, compared by identity; `read_plane` returns the same object for the same file."""

    def __init__(self, array: DoubleArray | None) -> None:
        self.array = array

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ArrayKey) and self.array is other.array

    def __hash__(self) -> int:
        return id(self.array)


@lru_cache(maxsize=16)
def _scaled_heights(front: _ArrayKey, back: _ArrayKey, scale_mm: tuple[float, float]) -> HeightField:
    """Scale height maps. The same files and scales give the same object, so that uploads are reused."""
    return HeightField(
        None if front.array is None or scale_mm[0] == 0 else front.array * scale_mm[0],
        None if back.array is None or scale_mm[1] == 0 else back.array * scale_mm[1],
    )


@lru_cache(maxsize=16)
def _iris(blades: int, roundness: float, rotation_rad: float, mask: _ArrayKey, weights: tuple[float, ...]) -> IrisShape:
    if mask.array is None:
        return IrisShape(blades, roundness, rotation_rad, None, weights)
    return IrisShape(
        mask=rotate_plane(mask.array, rotation_rad), radial_weights=weights
    )  # it takes the place of the blades


def _plane(asset: Asset, name: str, camera: str, confined_to: Path | None) -> DoubleArray | None:
    if not asset.path:
        return None
    try:
        return read_plane(asset.resolved, confined_to)
    except TextureError as problem:
        raise CameraError(f"{name} of camera {camera}: {asset.path} {problem}", path=camera) from problem


def _numbers(data: Any) -> Iterator[tuple[str, float]]:
    """Numbers of a schema and of its groups, with their property's names."""
    for item in fields(data):
        value = getattr(data, item.name)
        if "group" in item.metadata:
            yield from _numbers(value)
        elif "usd" in item.metadata:
            name = item.metadata["usd"].removeprefix("lens:")
            yield from ((name, number) for number in _floats(value))


def _floats(value: Any) -> Iterator[float]:
    if isinstance(value, float):
        yield value
    elif isinstance(value, tuple):
        for item in value:
            yield from _floats(item)


def _format_values(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values[:8]) + (", …" if len(values) > 8 else "")


def _error(camera: str, name: str, expected: str, got: str) -> CameraError:
    return CameraError(f"{name} of camera {camera} must be {expected}, got {got}", path=camera)
