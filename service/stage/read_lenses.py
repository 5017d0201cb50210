"""From the lens library to models. Runs in the stage process, the one that imports USD."""

from __future__ import annotations

from functools import lru_cache

from render.model.lens import Surface
from render.shot.lens.lens_alone import library_lens_alone
from render.shot.lens.lens_choice import library_entry
from render.stage.camera.lenses import lens_of
from service.models.lenses import Lens, LensErrors, LensGlass, LensIris, LensList, LensSummary, LensSurface, LensTables
from usd_schemas import LibraryLens, library_lenses


def list_lenses() -> LensList:
    """All lenses of the library."""
    return LensList(lenses=[_summary(entry) for entry in library_lenses()])


def read_lens(name: str) -> Lens:
    """One lens of the library.

    Raises:
        NotFoundError: there is none of that name.
    """
    entry = library_entry(name)
    prescription = lens_of(entry.lens, entry.name).prescription
    return Lens(
        **_summary(entry).model_dump(),
        squeeze=entry.lens.squeeze,
        surfaces=[_surface(surface) for surface in prescription.surfaces] if prescription else [],
        focus_group=prescription.focus_group if prescription else None,
        errors=LensErrors.model_validate(entry.lens.seidel) if entry.lens.model == "seidel" else None,
        tables=LensTables.model_validate(entry.lens.data_sheet) if entry.lens.model == "dataSheet" else None,
        iris=_iris(entry),
    )


@lru_cache(maxsize=64)
def draw_lens(name: str) -> bytes:
    """The section of a lens of the library, wide open and focused at infinity: SVG.

    Raises:
        NotFoundError: there is none of that name.
    """
    from render.drawing import section_svg  # matplotlib takes a second to load

    return section_svg(library_lens_alone(name).camera)


@lru_cache(maxsize=16)
def draw_lens_sheet(name: str) -> bytes:
    """All about a lens of the library on one sheet, wide open and focused at infinity: PNG.

    Raises:
        NotFoundError: there is none of that name.
    """
    from render.drawing import lens_sheet
    from render.optics.report import lens_report

    lens = library_lens_alone(name)
    return lens_sheet(lens, lens_report(lens.camera, lens.f_stop), "png")


def _summary(entry: LibraryLens) -> LensSummary:
    return LensSummary(
        name=entry.name,
        title=entry.lens.name,
        manufacturer=entry.lens.manufacturer,
        model=entry.lens.model,
        focal_length_mm=entry.focal_length_mm,
        f_stop=entry.f_stop,
        description=entry.description,
    )


def _surface(surface: Surface) -> LensSurface:
    return LensSurface(
        radius_mm=surface.radius_mm,
        thickness_mm=surface.thickness_mm,
        glass=None if surface.glass.index == 1 else LensGlass.model_validate(surface.glass),
        clear_diameter_mm=2 * surface.semi_diameter_mm,
        conic=surface.conic,
        aspheric=list(surface.aspheric),
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
