"""Drawings of lenses by matplotlib. Import it late: it takes a second."""

from render.drawing.lens_comparison import draw_lens_comparison
from render.drawing.lens_sheet import draw_lens_sheet
from render.drawing.section import draw_section_svg

__all__ = ["draw_lens_comparison", "draw_lens_sheet", "draw_section_svg"]
