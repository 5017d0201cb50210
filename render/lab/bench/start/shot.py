"""A small shot for the start bench: six prims, a light, and a camera with a prescription and a film."""

from __future__ import annotations

from pathlib import Path

from pxr import Usd

from render.lab.bench.soak.shot import CAMERA, write_soak_shot
from usd_schemas import FilmData, LensCamera, library_lens, mount_lens

LENS, STOCK = "planar_50", "vision3_500t_5219"


def write_small_shot(folder: Path) -> Path:
    """Write the soak's balls and floor, seen through a lens of the library on a film of the library.

    Args:
        folder: where; it must exist.

    Returns:
        The stage's file.
    """
    file = write_soak_shot(folder)
    stage = Usd.Stage.Open(str(file))
    camera = LensCamera(stage.GetPrimAtPath(CAMERA))
    lens = library_lens(LENS)
    mount_lens(camera, lens.lens, focal_length_mm=lens.focal_length_mm, f_stop=lens.f_stop, aperture=lens.aperture)
    camera.film.author(FilmData(process="negative", stock=STOCK))
    stage.Save()
    return file
