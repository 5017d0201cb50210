"""Radiance to a display's picture: exposure, then OpenColorIO's view of the scene."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import PyOpenColorIO

from render.errors import SettingsError
from render.film.grade import Grade
from render.model.arrays import FloatArray

# The largest half float. No display tells brighter light from it, and it keeps infinities out of the matrices.
_BRIGHTEST = np.float32(65504.0)
# OpenColorIO lets go of Python's lock while it works, so bands of the picture run at once; more than 8 gains little.
_MAX_THREADS = 8
_ROWS_IN_A_BAND = 64


def develop(radiance: FloatArray, exposure_scale: float, grade: Grade) -> FloatArray:
    """Expose radiance and convert it to the display's picture.

    The display transform works on each pixel alone, so the result does not depend on how many threads there are.

    Args:
        radiance: ``(height, width, 3 or more)`` scene-linear in the working space; channels after the third are left
            out. NaN counts as black, infinite as the brightest light.
        exposure_scale: factor on radiance, from the camera's exposure.
        grade: the display, view and look.

    Returns:
        ``(height, width, 3)`` float32, encoded for the display, from 0 to 1.

    Raises:
        SettingsError: the exposure is not a number from 0 up, or OpenColorIO cannot build the transform.
    """
    if radiance.ndim != 3 or radiance.shape[2] < 3:
        raise SettingsError(f"radiance must be (height, width, 3) or (height, width, 4), got {radiance.shape}")
    check_exposure(exposure_scale)
    return _apply_processor(expose(radiance[..., :3], exposure_scale), grade.cpu_processor())


def project(print_light: FloatArray, grade: Grade, space: str) -> FloatArray:
    """Show the light of a film's print or positive on a display: as it is, without the view's tone mapping.

    Args:
        print_light: ``(height, width, 3)`` linear, 1 = the display's white. NaN counts as black.
        grade: the display; its CDL and looks are those of a colourist who has the print before him.
        space: the linear space that the light is in, as for `Grade.processor`.

    Returns:
        ``(height, width, 3)`` float32, encoded for the display, from 0 to 1.

    Raises:
        SettingsError: no such picture, or OpenColorIO cannot build the transform.
    """
    if print_light.ndim != 3 or print_light.shape[2] != 3:
        raise SettingsError(f"print light must be (height, width, 3), got {print_light.shape}")
    return _apply_processor(expose(print_light, 1.0), grade.cpu_processor(space))


def _apply_processor(picture: FloatArray, processor: PyOpenColorIO.CPUProcessor) -> FloatArray:
    """Run a picture through OpenColorIO, in place."""
    bands = [picture[row : row + _ROWS_IN_A_BAND] for row in range(0, len(picture), _ROWS_IN_A_BAND)]
    with ThreadPoolExecutor(min(_MAX_THREADS, os.cpu_count() or 1)) as threads:
        list(threads.map(processor.applyRGB, bands))
    return np.clip(np.nan_to_num(picture, copy=False), 0, 1, out=picture)


def check_exposure(exposure_scale: float) -> None:
    """Raise `SettingsError` unless the scale is a finite number from 0 up."""
    if not (np.isfinite(exposure_scale) and exposure_scale >= 0):
        raise SettingsError(f"exposure scale must be a finite number from 0 up, got {exposure_scale}")


def expose(radiance: FloatArray, exposure_scale: float) -> FloatArray:
    """Radiance times exposure, with every number finite and within half-float range.

    Args:
        radiance: any shape, scene-linear.
        exposure_scale: the factor.

    Returns:
        The same shape, a new contiguous float32 array. NaN becomes 0.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        exposed = np.asarray(np.multiply(radiance, np.float32(exposure_scale), dtype=np.float32))
    np.nan_to_num(exposed, copy=False, nan=0.0)
    np.clip(exposed, -_BRIGHTEST, _BRIGHTEST, out=exposed)
    return np.ascontiguousarray(exposed)
