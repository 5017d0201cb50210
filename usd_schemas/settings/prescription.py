"""The surfaces of a lens, and what is added to them."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Asset, Floats, Pair, Pairs, Triples, schema_group, setting


@schema_group("Lens:Prescription")
@dataclass(frozen=True)
class Prescription:
    """The surfaces of a lens, front to rear: each array has one entry for each surface, or none."""

    radius: Floats = setting(
        "lens:prescription:radius",
        (),
        "Radii",
        "Radius of curvature of each surface, front to rear; positive where the centre of curvature lies toward the "
        "film, 0 for a plane (and for the stop).",
        "All lens:prescription arrays have one entry for each surface, or none.",
        unit="millimetres",
    )
    thickness: Floats = setting(
        "lens:prescription:thickness",
        (),
        "Thicknesses",
        "Distance along the axis from each surface to the next; the last is the back focal distance with the lens "
        "focused at infinity, 0 to have it solved for.",
        unit="millimetres",
    )
    index: Floats = setting(
        "lens:prescription:index",
        (),
        "Refractive Indices",
        "Refractive index at the d line (587.56 nm) of the medium behind each surface; 1 is air.",
        unit="none, a ratio of 1 or more",
    )
    abbe: Floats = setting(
        "lens:prescription:abbe",
        (),
        "Abbe Numbers",
        "Abbe number V_d of the medium behind each surface; 0 for no dispersion.",
        "Sellmeier coefficients, where given, win; else the dispersion is that of the glass that is named, or of glasses "
        "of about that index and Abbe number.",
        unit="none, a ratio",
    )
    sellmeier_b: Triples = setting(
        "lens:prescription:sellmeierB",
        (),
        "Sellmeier B",
        "B1, B2, B3 of the medium behind each surface, n^2 = 1 + sum B_i L^2 / (L^2 - C_i) with the wavelength L in "
        "micrometres; (0, 0, 0) where name, index and Abbe number say it.",
        unit="none",
    )
    sellmeier_c: Triples = setting(
        "lens:prescription:sellmeierC",
        (),
        "Sellmeier C",
        "C1, C2, C3 that belong to lens:prescription:sellmeierB.",
        unit="square micrometres",
    )
    glass: tuple[str, ...] = setting(
        "lens:prescription:glass",
        (),
        "Glass Names",
        'Catalogue name of the medium behind each surface, such as "N-BK7"; where index and Abbe number are those of that '
        "glass, so is the dispersion.",
        unit="none, text",
        keyable=False,
    )
    clear_diameter: Floats = setting(
        "lens:prescription:clearDiameter",
        (),
        "Clear Diameters",
        "Clear aperture (full diameter) of each surface; 0 where unknown, to be solved for.",
        "At the stop it is the diameter wide open.",
        unit="millimetres",
    )
    conic: Floats = setting(
        "lens:prescription:conic",
        (),
        "Conic Constants",
        "Conic constant K of each surface: 0 sphere, -1 paraboloid.",
        unit="none",
    )
    aspheric4: Floats = setting(
        "lens:prescription:aspheric4",
        (),
        "Aspheric A4",
        "Coefficient of r^4 in the sag of each surface, r the distance from the axis in millimetres.",
        unit="mm^-3",
    )
    aspheric6: Floats = setting(
        "lens:prescription:aspheric6",
        (),
        "Aspheric A6",
        "Coefficient of r^6 in the sag of each surface.",
        unit="mm^-5",
    )
    aspheric8: Floats = setting(
        "lens:prescription:aspheric8",
        (),
        "Aspheric A8",
        "Coefficient of r^8 in the sag of each surface.",
        unit="mm^-7",
    )
    aspheric10: Floats = setting(
        "lens:prescription:aspheric10",
        (),
        "Aspheric A10",
        "Coefficient of r^10 in the sag of each surface.",
        unit="mm^-9",
    )
    aspheric12: Floats = setting(
        "lens:prescription:aspheric12",
        (),
        "Aspheric A12",
        "Coefficient of r^12 in the sag of each surface.",
        unit="mm^-11",
    )
    aspheric14: Floats = setting(
        "lens:prescription:aspheric14",
        (),
        "Aspheric A14",
        "Coefficient of r^14 in the sag of each surface.",
        unit="mm^-13",
    )
    aspheric16: Floats = setting(
        "lens:prescription:aspheric16",
        (),
        "Aspheric A16",
        "Coefficient of r^16 in the sag of each surface.",
        unit="mm^-15",
    )
    aspheric18: Floats = setting(
        "lens:prescription:aspheric18",
        (),
        "Aspheric A18",
        "Coefficient of r^18 in the sag of each surface.",
        unit="mm^-17",
    )
    aspheric20: Floats = setting(
        "lens:prescription:aspheric20",
        (),
        "Aspheric A20",
        "Coefficient of r^20 in the sag of each surface.",
        unit="mm^-19",
    )
    aspheric3: Floats = setting(
        "lens:prescription:aspheric3",
        (),
        "Aspheric A3",
        "Coefficient of r^3 in the sag of each surface, r the distance from the axis in millimetres.",
        unit="mm^-2",
    )
    aspheric5: Floats = setting(
        "lens:prescription:aspheric5",
        (),
        "Aspheric A5",
        "Coefficient of r^5 in the sag of each surface.",
        unit="mm^-4",
    )
    aspheric7: Floats = setting(
        "lens:prescription:aspheric7",
        (),
        "Aspheric A7",
        "Coefficient of r^7 in the sag of each surface.",
        unit="mm^-6",
    )
    aspheric9: Floats = setting(
        "lens:prescription:aspheric9",
        (),
        "Aspheric A9",
        "Coefficient of r^9 in the sag of each surface.",
        unit="mm^-8",
    )
    aspheric11: Floats = setting(
        "lens:prescription:aspheric11",
        (),
        "Aspheric A11",
        "Coefficient of r^11 in the sag of each surface.",
        unit="mm^-10",
    )
    aspheric13: Floats = setting(
        "lens:prescription:aspheric13",
        (),
        "Aspheric A13",
        "Coefficient of r^13 in the sag of each surface.",
        unit="mm^-12",
    )
    aspheric15: Floats = setting(
        "lens:prescription:aspheric15",
        (),
        "Aspheric A15",
        "Coefficient of r^15 in the sag of each surface.",
        unit="mm^-14",
    )
    aspheric17: Floats = setting(
        "lens:prescription:aspheric17",
        (),
        "Aspheric A17",
        "Coefficient of r^17 in the sag of each surface.",
        unit="mm^-16",
    )
    aspheric19: Floats = setting(
        "lens:prescription:aspheric19",
        (),
        "Aspheric A19",
        "Coefficient of r^19 in the sag of each surface.",
        unit="mm^-18",
    )
    radius_across: Floats = setting(
        "lens:prescription:radiusAcross",
        (),
        "Radii Across",
        "Radius of curvature of each surface from side to side, where radius is that from top to bottom: a cylinder that "
        "squeezes the picture has a radius of 0 (straight) and a radius across.",
        "Equal radii and conic constants make a surface with rotational symmetry; without the array all surfaces have it.",
        unit="millimetres",
    )
    conic_across: Floats = setting(
        "lens:prescription:conicAcross",
        (),
        "Conic Constants Across",
        "Conic constant of each surface from side to side; without the array it is that from top to bottom.",
        unit="none",
    )
    torus: tuple[str, ...] = setting(
        "lens:prescription:torus",
        (),
        "Tori",
        'Curve of each surface that is turned about an axis across it to make a torus: "upright" for that from top to bottom, '
        '"across" for that from side to side; "" for any other surface.',
        "The other curve, a circle, has the radius of the turn and no conic constant. Aspheric terms are those of the curve that "
        "is turned, by the distance along it.",
        unit="none, text",
        keyable=False,
    )
    phase2: Floats = setting(
        "lens:prescription:phase2",
        (),
        "Phase P2",
        "Coefficient of r^2 in the phase that each surface adds by diffraction, r the distance from the axis in millimetres.",
        "Light of every wavelength gets the phase of the order that is used, and all of it goes there; a surface of negative "
        "phase makes light converge.",
        unit="radians mm^-2",
    )
    phase4: Floats = setting(
        "lens:prescription:phase4",
        (),
        "Phase P4",
        "Coefficient of r^4 in the phase that each surface adds by diffraction.",
        unit="radians mm^-4",
    )
    phase6: Floats = setting(
        "lens:prescription:phase6",
        (),
        "Phase P6",
        "Coefficient of r^6 in the phase that each surface adds by diffraction.",
        unit="radians mm^-6",
    )
    phase8: Floats = setting(
        "lens:prescription:phase8",
        (),
        "Phase P8",
        "Coefficient of r^8 in the phase that each surface adds by diffraction.",
        unit="radians mm^-8",
    )
    phase10: Floats = setting(
        "lens:prescription:phase10",
        (),
        "Phase P10",
        "Coefficient of r^10 in the phase that each surface adds by diffraction.",
        unit="radians mm^-10",
    )
    phase12: Floats = setting(
        "lens:prescription:phase12",
        (),
        "Phase P12",
        "Coefficient of r^12 in the phase that each surface adds by diffraction.",
        unit="radians mm^-12",
    )
    phase14: Floats = setting(
        "lens:prescription:phase14",
        (),
        "Phase P14",
        "Coefficient of r^14 in the phase that each surface adds by diffraction.",
        unit="radians mm^-14",
    )
    phase16: Floats = setting(
        "lens:prescription:phase16",
        (),
        "Phase P16",
        "Coefficient of r^16 in the phase that each surface adds by diffraction.",
        unit="radians mm^-16",
    )
    phase18: Floats = setting(
        "lens:prescription:phase18",
        (),
        "Phase P18",
        "Coefficient of r^18 in the phase that each surface adds by diffraction.",
        unit="radians mm^-18",
    )
    phase20: Floats = setting(
        "lens:prescription:phase20",
        (),
        "Phase P20",
        "Coefficient of r^20 in the phase that each surface adds by diffraction.",
        unit="radians mm^-20",
    )
    opening_shape: tuple[str, ...] = setting(
        "lens:prescription:openingShape",
        (),
        "Opening Shapes",
        'Shape, "ellipse", "rectangle" or "polygon", of the opening of each surface; "" where it has none.',
        "Light passes within it and within the clear diameter, which has to be wide enough for it. A circle is an ellipse of "
        "equal width and height.",
        unit="none, text",
        keyable=False,
    )
    opening_size: Pairs = setting(
        "lens:prescription:openingSize",
        (),
        "Opening Sizes",
        "Full width, from side to side, and full height of each surface's opening; (0, 0) where it has none.",
        unit="millimetres",
    )
    opening_centre: Pairs = setting(
        "lens:prescription:openingCentre",
        (),
        "Opening Centres",
        "Centre of each surface's opening, right and up from the axis as seen from behind the camera; without the array all "
        "are on the axis.",
        unit="millimetres",
    )
    opening_corners: Pairs = setting(
        "lens:prescription:openingCorners",
        (),
        "Opening Corners",
        "Corners of the openings that are polygons, right and up from the axis as seen from behind the camera, in the order "
        "of the surfaces; each polygon ends where its first corner is repeated.",
        "A polygon has from 3 to 64 corners, and edges that do not cross. Its size and its centre are those of its corners.",
        unit="millimetres",
        keyable=False,
    )
    obscuration_shape: tuple[str, ...] = setting(
        "lens:prescription:obscurationShape",
        (),
        "Obscuration Shapes",
        'Shape, "ellipse", "rectangle" or "polygon", of the obscuration of each surface; "" where it has none.',
        "No light passes within it. A round one makes a ring of the clear diameter.",
        unit="none, text",
        keyable=False,
    )
    obscuration_size: Pairs = setting(
        "lens:prescription:obscurationSize",
        (),
        "Obscuration Sizes",
        "Full width, from side to side, and full height of each surface's obscuration; (0, 0) where it has none.",
        unit="millimetres",
    )
    obscuration_centre: Pairs = setting(
        "lens:prescription:obscurationCentre",
        (),
        "Obscuration Centres",
        "Centre of each surface's obscuration, right and up from the axis as seen from behind the camera; without the array "
        "all are on the axis.",
        unit="millimetres",
    )
    obscuration_corners: Pairs = setting(
        "lens:prescription:obscurationCorners",
        (),
        "Obscuration Corners",
        "Corners of the obscurations that are polygons, right and up from the axis as seen from behind the camera, in the order "
        "of the surfaces; each polygon ends where its first corner is repeated.",
        "A polygon has from 3 to 64 corners, and edges that do not cross. Its size and its centre are those of its corners.",
        unit="millimetres",
        keyable=False,
    )
    coating_wavelength: Floats = setting(
        "lens:prescription:coatingWavelength",
        (),
        "Coating Wavelengths",
        "Wavelength for which each surface's quarter-wave coating is made; 0 for bare glass.",
        "It colours ghosts.",
        unit="nanometres",
    )
    stop_surface: int = setting(
        "lens:prescription:stopSurface",
        -1,
        "Stop Surface",
        "Index of the surface that is the aperture stop; -1 to have it solved for.",
        unit="none, an index from 0",
        keyable=False,
        hard=(-1, None),
    )
    focus_group: tuple[int, int] = setting(
        "lens:prescription:focusGroup",
        (-1, -1),
        "Focus Group",
        "First and last index of the surfaces that move to focus; (-1, -1) moves the whole lens.",
        unit="none, indices from 0",
        keyable=False,
    )
    focus_group_across: tuple[int, int] = setting(
        "lens:prescription:focusGroupAcross",
        (-1, -1),
        "Focus Group Across",
        "First and last index of the cylinders, without power from top to bottom, that move to focus from side to side; "
        "(-1, -1) where none does.",
        unit="none, indices from 0",
        keyable=False,
    )


@schema_group("Lens:Height Field")
@dataclass(frozen=True)
class HeightField:
    """Heights that are added to the two surfaces of a thick lens."""

    front: Asset = setting(
        "lens:heightField:front",
        Asset(),
        "Front Heights",
        "Image of the heights that are added to the first surface, over the square around its clear diameter, as "
        "seen from the film through the lens; its first channel is read as raw numbers.",
        unit="none, a file",
    )
    back: Asset = setting(
        "lens:heightField:back",
        Asset(),
        "Back Heights",
        "Image of the heights that are added to the second surface, as seen from the film like the first.",
        unit="none, a file",
    )
    scale: Pair = setting(
        "lens:heightField:scale",
        (0.0, 0.0),
        "Height Scales",
        "Height of an image value of 1, on the front and on the back surface; positive toward the film.",
        unit="millimetres",
    )
