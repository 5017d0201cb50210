"""Limits of the layers, for modules that do not draw."""

BLOCK_PX = 4
"""Side of a block of layer pixels in N-buffers and movers."""
EMPTY_MIN = 3.0e38
"""Lower end of an empty range, above every inverse depth."""
