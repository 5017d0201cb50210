"""The f-number of a lens whose file gives the entrance pupil instead."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from render.errors import InputError
from render.model.lens import Prescription
from render.optics.lens_files.lens_text import LensText
from render.optics.prescription.paraxial import focal_points, paraxial_system


def f_stop_of(lens: Prescription, entrance_pupil_mm: float, text: LensText) -> Prescription:
    """The lens with its f-number wide open: focal length over the entrance pupil's diameter.

    Args:
        lens: as read.
        entrance_pupil_mm: the pupil's diameter; 0 where the file gives none, and the lens stays as it is.
        text: the file.

    Raises:
        InputError: the lens has no focal length.
    """
    if entrance_pupil_mm <= 0:
        return lens
    try:
        with np.errstate(all="ignore"):  # numbers beyond all measure are refused below
            focal_length_mm, _, _ = focal_points(paraxial_system(lens))
    except InputError as error:
        raise text.error(error.detail) from error
    f_stop = abs(focal_length_mm) / entrance_pupil_mm
    if not (math.isfinite(f_stop) and f_stop > 0):
        raise text.error("the lens has no focal length, its numbers are beyond all measure")
    return replace(lens, f_stop=f_stop)
