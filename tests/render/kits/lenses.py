"""The six lenses that tests measure by: rows from patents, with focal lengths and back focal distances recomputed from them.

Numbers run front to rear, in millimetres. Where a patent gives no clear diameters (the two Zeiss lenses), the semi-diameters
are 0 (Distagon) or estimates (Planar), and the stop is as wide as the real beam of the stated f-number.
"""

from __future__ import annotations

from dataclasses import dataclass

from render.lab.bench.lenses import TELEPHOTO_ROWS, WIDE_ROWS, Row
from render.model.lens import AIR, Glass, Prescription, Surface

_DOUBLE_GAUSS: tuple[Row, ...] = (
    (29.475, 3.76, 1.67, 25.2),
    (84.83, 0.12, 1, 25.2),
    (19.275, 4.025, 1.67, 23),
    (40.77, 3.275, 1.699, 23),
    (12.75, 5.705, 1, 18),
    (0, 4.5, 0, 17.1),
    (-14.495, 1.18, 1.603, 17),
    (40.77, 6.065, 1.658, 20),
    (-20.385, 0.19, 1, 20),
    (437.065, 3.22, 1.717, 20),
    (-39.73, 0, 1, 20),
)
_FISHEYE: tuple[Row, ...] = (
    (30.2249, 0.8335, 1.62, 30.34),
    (11.3931, 7.4136, 1, 20.68),
    (75.2019, 1.0654, 1.639, 17.8),
    (8.3349, 11.1549, 1, 13.42),
    (9.5882, 2.0054, 1.654, 9.02),
    (43.8677, 5.3895, 1, 8.14),
    (0, 1.4163, 0, 6.08),
    (29.4541, 2.1934, 1.517, 5.96),
    (-5.2265, 0.9714, 1.805, 5.84),
    (-14.2884, 0.0627, 1, 5.96),
    (-22.3726, 0.94, 1.673, 5.96),
    (-15.0404, 0, 1, 6.52),
)

# radius, thickness, n_d, V_d (0, 0 is air), semi-diameter
GlassRow = tuple[float, float, float, float, float]

_PLANAR: tuple[GlassRow, ...] = (
    (44.452, 5.09105, 1.71700, 47.99, 19.5),
    (288.6605, 0.05885, 1, 0, 18.5),
    (21.8035, 4.85565, 1.78831, 47.37, 18.5),
    (34.062, 1.5891, 1, 0, 16),
    (47.086, 1.18695, 1.68893, 31.17, 15),
    (15.324, 14.27265 / 2, 1, 0, 13.5),
    (0, 14.27265 / 2, 1, 0, 24.292 / 2),
    (-17.3185, 1.1477, 1.72830, 28.68, 12.5),
    (374.0215, 5.1499, 1.78831, 47.37, 14.25),
    (-30.357, 0.28445, 1, 0, 14.75),
    (-87.426, 4.3848, 1.78831, 47.37, 15.25),
    (-28.25, 0.1275, 1, 0, 15.25),
    (164.6795, 2.8349, 1.74400, 44.77, 14.25),
    (-130.808, 0, 1, 0, 14),
)
_DISTAGON: tuple[GlassRow, ...] = (
    (291.6375, 2.21445, 1.5827, 46.5, 0),
    (32.4835, 11.4289, 1, 0, 0),
    (46.5535, 3.23505, 1.5481, 45.8, 0),
    (32.4835, 11.72745, 1, 0, 0),
    (45.556, 6.49915, 1.7130, 53.9, 0),
    (-394.555, 2.9078, 1, 0, 0),
    (-1664.775, 4.718, 1.7130, 53.9, 0),
    (-73.248, 0.0483, 1, 0, 0),
    (27.3315, 6.43195, 1.7130, 53.9, 0),
    (29.162, 6.5576, 1, 0, 0),
    (0, 8.2516 - 6.5576, 1, 0, 28.454 / 2),
    (-241.85, 2.3688, 1.5481, 45.8, 0),
    (39.4485, 4.46775, 1, 0, 0),
    (-41.489, 1.55015, 1.8467, 23.8, 0),
    (48.9545, 6.97095, 1.7883, 47.4, 0),
    (-32.956, 0.5971, 1, 0, 0),
    (308.875, 3.6876, 1.7883, 47.4, 0),
    (-52.6026, 0, 1, 0, 0),
)
_DISTAGON_ASPHERE, _DISTAGON_CONIC, _DISTAGON_A4 = 11, -1.0, -1.8505e-5


@dataclass(frozen=True)
class KnownLens:
    """A prescription as published, and what its publisher says of it.

    Attributes:
        prescription: as published: back focus 0, and clear diameters missing where they are.
        focal_length_mm: stated.
        back_focal_mm: stated.
        f_stop: stated, wide open.
        field_mm: image height that the lens is meant to cover.
    """

    prescription: Prescription
    focal_length_mm: float
    back_focal_mm: float
    f_stop: float
    field_mm: float


def _from_rows(name: str, rows: tuple[Row, ...]) -> Prescription:
    surfaces = (
        Surface(radius, thickness, AIR if n <= 1 else Glass(n), diameter / 2, is_stop=n == 0)
        for radius, thickness, n, diameter in rows
    )
    return Prescription(tuple(surfaces), name=name)


def _from_glass_rows(name: str, rows: tuple[GlassRow, ...], asphere: int | None = None) -> Prescription:
    surfaces = (
        Surface(
            radius,
            thickness,
            AIR if n == 1 else Glass(n, abbe),
            semi_diameter,
            conic=_DISTAGON_CONIC if index == asphere else 0.0,
            aspheric=(_DISTAGON_A4,) if index == asphere else (),
            is_stop=radius == 0,
        )
        for index, (radius, thickness, n, abbe, semi_diameter) in enumerate(rows)
    )
    return Prescription(tuple(surfaces), name=name)


DOUBLE_GAUSS = KnownLens(_from_rows("Double Gauss 50 mm", _DOUBLE_GAUSS), 50.36, 36.11, 2.0, 21.6)
WIDE = KnownLens(_from_rows("Wide 22 mm", WIDE_ROWS), 22.02, 14.32, 2.8, 18.0)
FISHEYE = KnownLens(_from_rows("Fisheye 10 mm", _FISHEYE), 9.99, 23.16, 4.0, 12.0)
TELEPHOTO = KnownLens(_from_rows("Telephoto 250 mm", TELEPHOTO_ROWS), 249.6, 105.07, 5.6, 21.6)
PLANAR = KnownLens(_from_glass_rows("Zeiss Planar 50/1.4", _PLANAR), 50.0, 35.498, 1.4, 21.6)
DISTAGON = KnownLens(_from_glass_rows("Zeiss Distagon 35/1.4", _DISTAGON, _DISTAGON_ASPHERE), 35.0, 34.498, 1.4, 21.6)

SIX_LENSES = (DOUBLE_GAUSS, WIDE, FISHEYE, TELEPHOTO, PLANAR, DISTAGON)
