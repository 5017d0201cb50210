"""The rays that a picture's pixels see through a lens, one sample of the pupil at a time, for each lens model.

A ray is given as `render.lab.reference.triangles` takes it: its position in the entrance pupil's plane, and its slope.
The camera's frame is the lens's own with its origin moved to the centre of the entrance pupil, since both look along -z.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from render.errors import SettingsError
from render.focus.surface import focused_at
from render.lab.reference.prescription_rays import PrescriptionRays, SceneRays
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import AberrationScales, SeidelErrors
from render.optics.glass import D_LINE_NM
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.pupil_power import drawn_defocus, is_drawn, own_scales
from render.optics.thin_lens import focal_surface, pupil_radius_m


class LensRays(Protocol):
    """A lens as it is set, with the samples of its pupil."""

    has_colours: bool
    """Whether wavelengths go different ways."""

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        """The rays of one sample of the pupil.

        Args:
            sample: its number.
            ideal: ``(h, w, 2)`` slopes of the rays that pixels see through a pinhole in the pupil's centre, right and up.
            wavelength_nm: of the light.
        """
        ...


def lens_rays(camera: Camera, pupil: DoubleArray, corner: tuple[float, float]) -> LensRays:
    """The camera's lens.

    Args:
        camera: with its lens.
        pupil: ``(n, 2)`` samples on the unit disc, right and up.
        corner: largest slopes, right and up, that a pixel has through a pinhole.

    Raises:
        SettingsError: the lens has a feature that this reference does not support.
    """
    plain = _unsqueeze(camera, pupil, corner)
    plain = _Drawn(plain, camera) if is_drawn(camera.lens) else plain
    return plain if camera.lens.squeeze == 1 else _Squeezed(plain, camera.lens.squeeze)


def _unsqueeze(camera: Camera, pupil: DoubleArray, corner: tuple[float, float]) -> LensRays:
    lens = camera.lens
    if camera.f_stop > 0 and lens.model == "dataSheet":
        raise SettingsError("the ray-by-ray reference knows no lens by its data sheet")
    if camera.f_stop > 0 and lens.model == "seidel" and lens.seidel is not None:
        return _Seidel(camera, pupil, lens.seidel)
    if has_surfaces(camera):
        if lens.has_cylinders:
            raise SettingsError("the ray-by-ray reference knows no lenses with cylinders")
        if lens.prescription is not None and lens.prescription.is_diffractive:
            raise SettingsError("the ray-by-ray reference knows no lenses with diffractive surfaces")
        if lens.has_outlines:
            raise SettingsError("the ray-by-ray reference knows no lenses with openings or obscurations")
        if camera.focal_surface is not None:
            raise SettingsError("the ray-by-ray reference knows lenses with surfaces focused at a distance alone")
        if own_scales(lens) != AberrationScales():
            raise SettingsError(
                f"the ray-by-ray reference knows lenses with surfaces as they are, got {own_scales(lens)}"
            )
        return PrescriptionRays(
            mount_lens(camera), pupil, corner, lens.height_field if lens.model == "heightField" else None
        )
    return _Thin(camera, pupil)


class _Thin:
    """A thin lens without errors: ``s(w) = p + l·(w − w_f)`` (DESIGN, section 2), with whatever focal surface."""

    has_colours = False

    def __init__(self, camera: Camera, pupil: DoubleArray) -> None:
        self._points_m, self._surface = pupil * pupil_radius_m(camera), focal_surface(camera)

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        w_f, pupil = focused_at(self._surface, ideal)
        points = pupil[..., None] * self._points_m[sample]
        return SceneRays(points, ideal - points * w_f[..., None], np.ones(ideal.shape[:2]))


class _Drawn:
    """A lens whose power is drawn over the pupil: rays through it at some radius are focused nearer."""

    def __init__(self, lens: LensRays, camera: Camera) -> None:
        self._lens, self._camera, self.has_colours = lens, camera, lens.has_colours
        glass = has_surfaces(camera)
        self._radius_m = mount_lens(camera).entrance_pupil_radius_mm / 1000 if glass else pupil_radius_m(camera)

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        rays = self._lens.rays(sample, ideal, wavelength_nm)
        radius = np.linalg.norm(rays.offsets, axis=-1) / self._radius_m
        nearer = drawn_defocus(self._camera.lens, self._camera.focal_length_mm, radius)
        return SceneRays(rays.offsets, rays.slopes - rays.offsets * nearer[..., None], rays.weights)


class _Squeezed:
    """An anamorphic lens, its picture stretched back: pupil and errors are as many times narrower from side to side."""

    def __init__(self, lens: LensRays, squeeze: float) -> None:
        self._lens, self._narrowing, self.has_colours = lens, np.array([1 / squeeze, 1.0]), lens.has_colours

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        rays = self._lens.rays(sample, ideal, wavelength_nm)
        slopes = ideal + (rays.slopes - ideal) * self._narrowing
        return SceneRays(rays.offsets * self._narrowing, slopes, rays.weights)


class _Seidel:
    """A thin lens with third-order errors, from the wavefront of `render.model.lens.SeidelErrors` itself.

    A ray through pupil point X reaches the film ``v·∂W/∂X`` short of its ideal image, so the pixel there sees the direction whose
    image is that much farther: its slope in object space is off by ``−∂W/∂X``, η and φ being those of the film point, which lies
    opposite to the pixel. Colour moves the focus and the image's height, in proportion to the wavelength.
    """

    has_colours = True

    def __init__(self, camera: Camera, pupil: DoubleArray, errors: SeidelErrors) -> None:
        self._thin, self._pupil, self._errors = _Thin(camera, pupil), pupil, errors
        self._scales = own_scales(camera.lens)
        self._focal_mm = camera.focal_length_mm
        self._edge = errors.reference_f_stop / camera.f_stop  # the pupil's radius over that of the reference f-number

    def rays(self, sample: int, ideal: DoubleArray, wavelength_nm: float) -> SceneRays:
        e, k = self._errors, self._scales
        thin = self._thin.rays(sample, ideal, wavelength_nm)
        u = np.broadcast_to(self._pupil[sample] * self._edge, ideal.shape)
        film = -ideal * self._focal_mm / e.reference_height_mm  # η in the direction of the image point
        along, u2, film2 = ((a * b).sum(-1, keepdims=True) for a, b in ((u, film), (u, u), (film, film)))
        gradient = (
            4 * k.spherical * e.w040 * u2 * u
            + k.coma * e.w131 * (2 * along * u + u2 * film)
            + 2 * k.astigmatism * e.w222 * along * film
            + 2 * k.field_curvature * e.w220 * film2 * u
            + k.distortion * e.w311 * film2 * film
        )
        reference_mm = self._focal_mm / (2 * e.reference_f_stop)
        wavefront = D_LINE_NM * 1e-6 / reference_mm * gradient
        blueness = k.chromatic * (562.5 - wavelength_nm) / (650.0 - 475.0)
        later = blueness * e.axial_color_mm / self._focal_mm**2 * reference_mm * u
        larger = blueness * e.lateral_color_mm / self._focal_mm * film
        return SceneRays(thin.offsets, thin.slopes - wavefront + later + larger, thin.weights)
