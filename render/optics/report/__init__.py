"""What can be said of a lens on its own, in numbers: `lens_report`. Drawings of it are `render.drawing`'s."""

from render.optics.report.data_sheet import data_sheet
from render.optics.report.lens_report import LensReport, lens_report

__all__ = ["LensReport", "data_sheet", "lens_report"]
