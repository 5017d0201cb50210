"""A lens by data sheet that has every error."""

from __future__ import annotations

from render.model.data_sheet import DataSheet

SHEET = DataSheet(
    heights_mm=(0.0, 5.0, 10.0, 15.0, 21.6),
    distortion=(0.0, -0.002, -0.008, -0.015, -0.02),
    light=(1.0, 0.95, 0.8, 0.6, 0.35),
    sagittal_blur_mm=(0.006, 0.008, 0.01, 0.015, 0.02),
    tangential_blur_mm=(0.006, 0.009, 0.014, 0.02, 0.03),
    spherical=(0.6, 0.5, -0.4, 0.2, 0.0),
    coma_mm=(0.0, 0.005, 0.01, -0.02, 0.03),
    field_curvature_mm=(0.0, 0.01, 0.02, 0.03, -0.02),
    lateral_color_mm=(0.0, 0.002, 0.004, 0.006, 0.01),
    axial_color_mm=(0.05, 0.05, 0.05, 0.05, 0.05),
    f_stop=1.4,
)
