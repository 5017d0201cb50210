"""Measurements of a lens on its own: `lens_report`. Drawings of it are in `render.drawing`."""

from render.optics.report.data_sheet import data_sheet
from render.optics.report.lens_report import LensReport, lens_report

__all__ = ["LensReport", "data_sheet", "lens_report"]
