"""Captured sets of Gaussian splats, from the files of the programs that fit them."""

from render.shot.splats.layer import write_splats
from render.shot.splats.ply import CapturedSplats, read_ply

__all__ = ["CapturedSplats", "read_ply", "write_splats"]
