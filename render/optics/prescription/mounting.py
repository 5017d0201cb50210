"""A camera's glass as it stands before the film: completed, scaled to the camera's focal length, and focused.

A lens of one focal length is as long as its camera's focal length says, as if it were built for it: the field of view stays what
focal length and film gate say, and an f-number does not change with scale. A zoom is set to the camera's focal length; beyond its
range the nearer end is scaled.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from render.model.camera import Camera
from render.model.lens import Prescription
from render.optics.prescription.completion import complete_prescription, scale_prescription
from render.optics.prescription.focusing import FocusedLens, focus_lens
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.zooming import set_focal_length, zoom_of

PRESCRIBED = ("spherical", "heightField", "prescription")
"""Models that have surfaces."""
_MARK_WIDTH = 1e-3  # of the distance: who focuses on the mark is not beyond it


def has_surfaces(camera: Camera) -> bool:
    """Whether rays pass real surfaces: a lens that has them, and is not stopped down to a pinhole."""
    return camera.lens.model in PRESCRIBED and camera.lens.prescription is not None and camera.f_stop > 0


def mount_lens(camera: Camera) -> FocusedLens:
    """The camera's prescription, focused at its focus distance and f-number.

    Raises:
        InputError: the prescription is no lens.
        SettingsError: it does not reach the focus distance.
    """
    prescription = camera.lens.prescription
    if prescription is None:
        raise ValueError(f"the lens of camera {camera.path} has no surfaces")
    glass = scale_to(prescription, camera.focal_length_mm, camera.covered_mm / 2)
    return _focus_lens(glass, camera.focus_distance_m, camera.f_stop)


def breathing_ratio(camera: Camera) -> float:
    """Image scale of the mounted lens over its focal length: the growth of its picture relative to focus at infinity."""
    return mount_lens(camera).image_scale_mm / camera.focal_length_mm


def distance_from_film_m(camera: Camera) -> float:
    """Focus distance measured from the film, as makers engrave it; the camera's own is measured from the entrance pupil.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance.
    """
    distance_m = camera.focus_distance_m
    if not 0 < distance_m < np.inf:
        return float("inf")
    if has_surfaces(camera):
        lens = mount_lens(camera)
        return distance_m + (lens.film_mm - lens.entrance_pupil_mm) / 1000
    focal_m = camera.focal_length_mm / 1000
    return distance_m + 1 / max(1 / focal_m - 1 / distance_m, 1e-9)


def nearer_than_marked(camera: Camera) -> bool:
    """Whether the camera is focused nearer than the close focus that is engraved on its lens.

    Raises:
        InputError: the prescription is no lens.
        SettingsError: it does not reach the focus distance.
    """
    marked_m = camera.lens.close_focus_m
    return marked_m > 0 and distance_from_film_m(camera) < marked_m * (1 - _MARK_WIDTH)


def beyond_zoom_range(camera: Camera) -> tuple[float, float] | None:
    """Range of the camera's zoom, shortest and longest focal length in mm, where its own is not in it; else None.

    Raises:
        InputError: the prescription is no lens.
    """
    prescription = camera.lens.prescription
    zoom = zoom_of(prescription) if has_surfaces(camera) and prescription is not None else None
    return None if zoom is None or zoom.holds(camera.focal_length_mm) else (zoom.shortest_mm, zoom.longest_mm)


@lru_cache(maxsize=64)
def scale_to(prescription: Prescription, focal_length_mm: float, image_height_mm: float) -> Prescription:
    prescription = set_focal_length(prescription, focal_length_mm)
    own = first_order(complete_prescription(prescription, image_height_mm=image_height_mm)).focal_length_mm
    # completed again at its own scale, since computed values depend on the film format
    whole = complete_prescription(prescription, image_height_mm=image_height_mm * own / focal_length_mm)
    return scale_prescription(whole, focal_length_mm / own)


@lru_cache(maxsize=64)
def _focus_lens(prescription: Prescription, focus_distance_m: float, f_stop: float) -> FocusedLens:
    return focus_lens(prescription, focus_distance_m, f_stop)
