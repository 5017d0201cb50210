"""Functions of the stage process that read the lens library."""

from __future__ import annotations

import math
from functools import lru_cache

from render.errors import NotFoundError, SettingsError
from render.model.lens import Prescription, Surface
from render.optics.prescription.zooming import zoom_positions
from render.optics.report import lens_report
from render.shot.lens.lens_alone import library_lens_alone
from render.shot.lens.lens_choice import THIN, LensChoice, library_choice, library_entry
from render.stage.camera.lenses import make_lens
from service.models.lenses import (
    Lens,
    LensConfiguration,
    LensErrors,
    LensGlass,
    LensIris,
    LensList,
    LensSummary,
    LensSurface,
    LensTables,
    StatedLens,
)
from service.stage.opened import OpenedShot, stage_function
from usd_schemas import LensSearch, LibraryLens, SchemaError, library_lenses


@stage_function
def list_lenses(
    opened: OpenedShot,
    focal_length_mm: tuple[float, float],
    faster_than: float,
    family: str,
    years: tuple[float, float],
    words: str,
) -> LensList:
    """List lenses of the library; parameters as in `usd_schemas.LensSearch`. A range that ends before it begins finds none.

    Raises `SettingsError`.
    """
    if focal_length_mm[0] > focal_length_mm[1] or years[0] > years[1]:
        return LensList(lenses=[])
    try:
        search = LensSearch(focal_length_mm, faster_than, family, years, words)
    except SchemaError as error:
        raise SettingsError(str(error)) from error
    return LensList(lenses=[_summary(entry) for entry in library_lenses() if search.finds(entry)])


@stage_function
def read_library_lens(opened: OpenedShot, name: str) -> Lens:
    """Read one lens of the library. Raises `NotFoundError`."""
    entry = library_entry(name)
    prescription = make_lens(entry.lens, entry.name).prescription
    return Lens(
        **_summary(entry).model_dump(),
        stated=StatedLens.model_validate(entry.stated) if entry.stated else None,
        squeeze=entry.lens.squeeze,
        surfaces=[_surface(surface) for surface in prescription.surfaces] if prescription else [],
        focus_group=prescription.focus_group if prescription else None,
        configurations=_configurations(prescription) if prescription else [],
        errors=LensErrors.model_validate(entry.lens.seidel) if entry.lens.model == "seidel" else None,
        tables=LensTables.model_validate(entry.lens.data_sheet) if entry.lens.model == "dataSheet" else None,
        iris=_iris(entry),
    )


@stage_function
def draw_lens_section(opened: OpenedShot, name: str) -> bytes:
    """Draw the section of a lens of the library, wide open and focused at infinity, as SVG. Raises `NotFoundError`."""
    return _section_svg(name)


@lru_cache(maxsize=64)
def _section_svg(name: str) -> bytes:
    from render.drawing import draw_section_svg  # matplotlib takes a second to import

    return draw_section_svg(library_lens_alone(name).camera)


@stage_function
def draw_lens_sheet(opened: OpenedShot, name: str) -> bytes:
    """Draw the data sheet of a lens of the library, wide open and focused at infinity, as PNG. Raises `NotFoundError`."""
    return _sheet_png(name)


@lru_cache(maxsize=16)
def _sheet_png(name: str) -> bytes:
    from render.drawing import draw_lens_sheet  # matplotlib takes a second to import

    lens = library_lens_alone(name)
    return draw_lens_sheet(lens, lens_report(lens.camera, lens.f_stop), "png")


def lens_to_mount(name: str | None) -> LensChoice:
    """Return the library lens that an edit of a camera names; None is the thin lens.

    Raises:
        SettingsError: the library has no lens of that name.
    """
    try:
        return THIN if name is None else library_choice(name)
    except NotFoundError as error:  # the resource exists; the value sent for it is wrong
        raise SettingsError(error.detail, code=error.code, path="lens") from error


def _summary(entry: LibraryLens) -> LensSummary:
    return LensSummary(
        name=entry.name,
        title=entry.lens.name,
        manufacturer=entry.lens.manufacturer,
        model=entry.lens.model,
        focal_length_mm=entry.focal_length_mm,
        focal_length_range_mm=entry.focal_length_range_mm,
        f_stop=entry.f_stop,
        families=list(entry.families),
        year=entry.year,
        source=entry.source,
        description=entry.description,
    )


def _configurations(prescription: Prescription) -> list[LensConfiguration]:
    return [
        LensConfiguration(
            focal_length_mm=position.focal_length_mm,
            object_distance_mm=each.object_mm if math.isfinite(each.object_mm) else None,
            f_stop=each.f_stop or None,
            thicknesses_mm=list(each.thicknesses_mm),
        )
        for position in zoom_positions(prescription)
        for each in (position.far, *position.near)
    ]


def _surface(surface: Surface) -> LensSurface:
    return LensSurface(
        radius_mm=surface.radius_mm,
        thickness_mm=surface.thickness_mm,
        glass=None if surface.glass.index == 1 else LensGlass.model_validate(surface.glass),
        clear_diameter_mm=2 * surface.semi_diameter_mm,
        conic=surface.conic,
        aspheric=list(surface.aspheric),
        odd=list(surface.odd),
        is_stop=surface.is_stop,
    )


def _iris(entry: LibraryLens) -> LensIris | None:
    iris = entry.aperture
    if iris is None:
        return None
    return LensIris(
        blades=iris.blades,
        roundness=iris.roundness,
        rotation=iris.rotation,
        radial_weights=list(iris.radial_weights),
    )
