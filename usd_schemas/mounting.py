"""Mounts a lens on a camera: its glass, its focal length, and no wider an iris than it has."""

from __future__ import annotations

from dataclasses import dataclass

from pxr import Usd

from usd_schemas import binding
from usd_schemas.applying import applied
from usd_schemas.keys import following_interpolation, set_key
from usd_schemas.lens_library import library_lenses, zoom_range_mm
from usd_schemas.settings import ApertureData, Configurations, DataSheet, HeightField, LensData, Prescription, Seidel
from usd_schemas.units import mm_from_tenths, tenths_from_mm
from usd_schemas.values import is_animated, read_value, stored_value, usd_value
from usd_schemas.view import LensCamera

_BARREL = (
    "lens:model",
    "lens:name",
    "lens:manufacturer",
    "lens:serialNumber",
    "lens:transmittance",
    "lens:stopMarking",
    "lens:squeeze",
    "lens:closeFocus",
    "lens:focusThrow",
    "lens:fStopRange",
    "lens:pupilMagnification",
    "lens:entrancePupilOffset",
)
_GLASS = tuple(
    name
    for kind in (Prescription, Configurations, Seidel, HeightField, DataSheet)
    for name in binding.property_names(kind)
)
_ROUNDED = 1e-3  # share of a focal length: who sets a zoom to its end is within its range


@dataclass(frozen=True)
class Mounted:
    """Changes that mounting a lens made to the camera's own numbers.

    Attributes:
        focal_length_mm: what it is now; None where the camera's stayed.
        f_stop: what the smallest of its f-numbers was raised to; None where none had to be.
    """

    focal_length_mm: float | None
    f_stop: float | None


def mount_lens(
    camera: LensCamera,
    lens: LensData,
    *,
    focal_length_mm: float | None = None,
    f_stop: float = 0.0,
    aperture: ApertureData | None = None,
) -> Mounted:
    """Put a lens on a camera, in the stage's edit target and for all time.

    What belongs to the lens replaces what the camera says of the one before: its barrel, its glass, and its iris where that came
    from the library with it. What the photographer sets stays: filters, breathing, factors on errors.

    Args:
        camera: the camera.
        lens: what LensAPI shall say.
        focal_length_mm: of the lens; None keeps the camera's. A zoom keeps the camera's where its range has one of them, and
            else takes the nearer end of its range.
        f_stop: the lens's f-number wide open; the camera's are raised to it. 0 leaves them.
        aperture: the lens's own iris; None keeps the camera's.

    Raises:
        SchemaError: a value is not allowed; what was authored before it stays, so edit within something that takes it back.
    """
    _take_off_iris(camera)
    with applied(camera.prim, "LensAPI"):
        _author(camera.prim, lens, (*_BARREL, *_GLASS))
    if aperture is not None:
        with applied(camera.prim, "ApertureAPI"):
            _author(camera.prim, aperture, tuple(binding.property_names(ApertureData)))
    if focal_length_mm is not None and (zoom_mm := zoom_range_mm(lens)) is not None:
        focal_length_mm = _outside(camera, zoom_mm)
    if focal_length_mm is not None:
        attribute = camera.prim.GetAttribute("focalLength")
        binding.author_for_all_time(attribute, tenths_from_mm(focal_length_mm, camera.prim.GetStage()))
    return Mounted(focal_length_mm, f_stop if _raise_f_stop(camera.prim, f_stop) else None)


def _outside(camera: LensCamera, zoom_mm: tuple[float, float]) -> float | None:
    """End of a zoom's range that is nearest to the camera's first focal length; None where the range has one of them."""
    attribute, stage = camera.prim.GetAttribute("focalLength"), camera.prim.GetStage()
    animated = is_animated(attribute)
    tenths = [key.value for key in camera.keys("focalLength")] if animated else [read_value(attribute)]
    lengths_mm = [mm_from_tenths(float(value), stage) for value in tenths if value is not None]
    shortest, longest = zoom_mm
    if not lengths_mm or any(shortest * (1 - _ROUNDED) <= each <= longest * (1 + _ROUNDED) for each in lengths_mm):
        return None
    return shortest if lengths_mm[0] < shortest else longest


def _take_off_iris(camera: LensCamera) -> None:
    """Give back the iris that the camera had before a lens of the library brought its own."""
    name, iris = camera.lens.read().name, camera.aperture.read()
    if not any(entry.lens.name == name and entry.aperture == iris for entry in library_lenses()):
        return
    for attribute in [camera.prim.GetAttribute(name) for name in binding.property_names(ApertureData)]:
        attribute.Clear()
    if camera.aperture.read() == iris:  # it is a weaker layer's
        _author(camera.prim, ApertureData(), tuple(binding.property_names(ApertureData)))


def _author(prim: Usd.Prim, data: LensData | ApertureData, names: tuple[str, ...]) -> None:
    for name, value in binding.property_values(data):
        if name in names:
            binding.author_for_all_time(prim.GetAttribute(name), value)


def _raise_f_stop(prim: Usd.Prim, least: float) -> bool:
    """Raise each f-number below the least to it; whether there was one."""
    attribute = prim.GetAttribute("fStop")
    if not is_animated(attribute):
        f_stop = read_value(attribute)
        if f_stop is not None and f_stop >= stored_value(attribute, least):
            return False
        attribute.Set(usd_value(attribute, least))
        return True
    low = [key for key in LensCamera(prim).keys("fStop") if key.value < stored_value(attribute, least)]
    for key in low:
        set_key(attribute, key.time, least, following_interpolation(attribute, key.time))
    return bool(low)
