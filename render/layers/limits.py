"""Limits of the layers that those need to know who draw none."""

BLOCK_PX = 4
"""Side of the blocks of layer pixels over which is noted what they hold."""
EMPTY_MIN = 3.0e38
"""Lower end of an empty range, above every inverse depth."""
