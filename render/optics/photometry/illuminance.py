"""Illuminance of the film from a luminance in the scene, and its falloff over the picture.

Geometry alone (Ray, *Applied Photographic Optics*, 3rd ed. 2002; Kyaw 2013, eq. 4.9):

    E = V · π · T · L · cos⁴θ / (4 · N² · (1 + m/P)²)

with E the illuminance of the film in lux and L the luminance of what is seen there, in cd/m² (nits). `LightPath` names N, T, m
and P, which are the same all over the film; V is the part of the beam that no rim blocks, θ the angle of the chief ray to the
axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from render.errors import SettingsError
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.optics.photometry.exposure import check_positive
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.view import PinholeView


@dataclass(frozen=True)
class LightPath:
    """Light path between a surface of the scene and the film: the terms of the illuminance that are constant over the
    surface.

    Attributes:
        f_stop: N, relative aperture: focal length over the diameter of the entrance pupil; of glass, over that of the real beam.
        transmittance: T, share of the light that glass and filters let through (`nd_transmittance` is a filter's).
        magnification: m, size of the image over the object's; 0 focused at infinity.
        pupil_magnification: P, diameter of the exit pupil over the entrance pupil's.

    Raises:
        SettingsError: a number is out of range.
    """

    f_stop: float
    transmittance: float = 1.0
    magnification: float = 0.0
    pupil_magnification: float = 1.0

    def __post_init__(self) -> None:
        check_positive("the f-number of a lens", self.f_stop)
        check_positive("pupil magnification", self.pupil_magnification)
        if not 0 <= self.transmittance <= 1:
            raise SettingsError(f"transmittance must be from 0 to 1, got {self.transmittance:g}")
        if not 0 <= self.magnification < math.inf:
            raise SettingsError(f"magnification must be 0 or more, got {self.magnification:g}")

    @property
    def bellows_factor(self) -> float:
        """Factor ``(1 + m/P)²`` on the exposure time relative to focus at infinity."""
        return (1 + self.magnification / self.pupil_magnification) ** 2

    @property
    def effective_f_stop(self) -> float:
        """``N · (1 + m/P)``: distance of the film from the exit pupil over that pupil's diameter."""
        return self.f_stop * math.sqrt(self.bellows_factor)

    @property
    def t_stop(self) -> float:
        """``N / √T``: the f-number of a lens without losses that is as bright; infinite where nothing comes through."""
        return self.f_stop / math.sqrt(self.transmittance) if self.transmittance > 0 else math.inf

    @property
    def effective_t_stop(self) -> float:
        """The T-stop as focused: ``N · (1 + m/P) / √T``."""
        return self.t_stop * math.sqrt(self.bellows_factor)


def illuminance_lux(
    luminance_nits: ArrayLike, path: LightPath, *, cos_theta: ArrayLike = 1.0, vignetting: ArrayLike = 1.0
) -> DoubleArray:
    """Illuminance of the film (the equation at the head of this module). Arguments are broadcast.

    Args:
        luminance_nits: L, luminance of the surface seen there.
        path: N, T, m and P.
        cos_theta: of the angle between chief ray and axis.
        vignetting: V, the part of the beam that no rim blocks.
    """
    light = np.asarray(luminance_nits, np.float64) * np.asarray(vignetting) * np.asarray(cos_theta) ** 4
    return np.asarray(light * (math.pi * path.transmittance / (4 * path.f_stop**2 * path.bellows_factor)))


def magnification(focal_length_mm: float, focus_distance_m: float, pupil_magnification: float = 1.0) -> float:
    """m of a lens that moves as a whole to focus: ``f / (u - f/P)`` with u from the entrance pupil, as all distances here.

    The object is ``f · (1 - 1/P)`` farther from the front principal plane, where the textbooks' ``m = f / (u - f)`` counts from.

    Args:
        focal_length_mm: f.
        focus_distance_m: u; 0 or infinite is infinity.
        pupil_magnification: P.

    Raises:
        SettingsError: a number is out of range, or the lens forms no image of what is so near.
    """
    check_positive("focal length in mm", focal_length_mm)
    check_positive("pupil magnification", pupil_magnification)
    if focus_distance_m == 0 or math.isinf(focus_distance_m):
        return 0.0
    beyond_mm = 1000 * focus_distance_m - focal_length_mm / pupil_magnification
    if not beyond_mm > 0:
        raise SettingsError(
            f"a lens of {focal_length_mm:g} mm forms no image of what is {focus_distance_m:g} m before its entrance pupil:"
            f" expected more than {focal_length_mm / pupil_magnification / 1000:g} m",
            code="bad_focus_distance",
        )
    return focal_length_mm / beyond_mm


def light_path(camera: Camera) -> LightPath:
    """N, T, m and P of a camera as it is focused.

    A prescription's are its own. A lens without surfaces has the pupil magnification that it is given. One that does not breathe
    shows what it would show focused at infinity whatever the distance (DESIGN section 2), and so is its light: m is 0.

    Args:
        camera: its f-number is not 0.

    Raises:
        InputError: the prescription is no lens.
        SettingsError: it is a pinhole, or does not reach the focus distance.
    """
    passes = camera.lens.transmittance
    if not has_surfaces(camera):
        f_mm, distance_m = camera.focal_length_mm, camera.focus_distance_m
        m = magnification(f_mm, distance_m) if camera.breathing else 0.0  # that of the picture, which is a thin lens's
        return LightPath(camera.f_stop, passes, m, camera.lens.pupil_magnification)
    lens = mount_lens(camera)
    if not camera.breathing:
        return LightPath(lens.f_stop, passes, pupil_magnification=lens.pupil_magnification)
    distance_mm = 1000 * camera.focus_distance_m or math.inf
    return LightPath(
        f_stop=lens.first.focal_length_mm / (2 * lens.entrance_pupil_radius_mm),
        transmittance=passes,
        magnification=abs(lens.image_scale_mm) / distance_mm,
        pupil_magnification=lens.pupil_magnification,
    )


UNVIGNETTED = ("pinhole", "thin", "seidel")
"""Models whose rays have equal weights; those of a data sheet do where it has no falloff."""


def light_over_picture(camera: Camera, width: int, height: int, *, is_pinhole: bool = False) -> FloatArray | None:
    """Relative light over the picture, where the lens's rays do not carry it; None where they do, or where it is 1
    everywhere.

    Args:
        camera: camera whose lens says whether light falls off.
        width: picture width in pixels.
        height: picture height in pixels.
        is_pinhole: whether the picture is drawn as a pinhole's, whatever the lens.

    Returns:
        ``(height, width)``.
    """
    sheet = camera.lens.data_sheet
    says_none = camera.lens.model == "dataSheet" and (sheet is None or not sheet.light)
    is_pinhole = is_pinhole and (camera.lens.model != "dataSheet" or says_none)  # a sheet's light is put on the picture
    has_none = camera.lens.model in UNVIGNETTED or says_none or is_pinhole or camera.f_stop == 0
    if not (camera.lens.natural_vignetting and has_none and camera.lens.scales.vignetting != 0):
        return None
    return natural_vignetting(PinholeView.from_camera(camera, width, height), camera.lens.scales.vignetting)


def natural_vignetting(view: PinholeView, strength: float = 1.0) -> FloatArray:
    """Natural vignetting cos⁴θ over a picture, for a lens without rims.

    For lenses without surfaces (thin, Seidel), whose rays are all of one weight. A prescription's table has the fall-off of the
    real lens already, rims and all.

    Args:
        view: the picture, from the centre of the entrance pupil.
        strength: its strength, in stops relative to the law's own, as `render.model.lens.AberrationScales` has
            vignetting.

    Returns:
        ``(height, width)``, at the centres of pixels; 1 on the axis.
    """
    x = (np.arange(view.width) + 0.5 - view.cx) / view.fx
    y = (np.arange(view.height) + 0.5 - view.cy) / view.fy
    return np.asarray((1 + x**2 + y[:, None] ** 2) ** (-2.0 * strength), np.float32)
