"""Drawings of lenses, by matplotlib: a whole sheet about one lens, and its section alone. Import it late: it takes a second."""

from render.drawing.section import section_svg
from render.drawing.sheet import lens_sheet

__all__ = ["lens_sheet", "section_svg"]
