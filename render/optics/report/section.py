"""Section of a lens along its axis with the rays of three beams, for a section drawing, in the lens's own millimetres.

z grows from the scene to the film, 0 at the front vertex of the lens focused at infinity (or at an ideal lens); y is up.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.lens import Surface
from render.optics.glass import D_LINE_NM
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.meridians import turned
from render.optics.prescription.mounting import has_surfaces, mount_lens
from render.optics.prescription.surface_shape import sag_mm
from render.optics.prescription.tracing import PASSES
from render.optics.report.aiming import trace_aimed
from render.optics.report.field import image_circle_mm, radial
from render.optics.report.glass_rays import GlassRays
from render.optics.report.lens_report import film_rays
from render.optics.thin_lens import focus_w

BEAM_FIELDS = (0.0, 0.7, 1.0)
"""Image heights of the beams, over that of the gate's corner, or of the last light where that ends before."""
_FAN = np.linspace(-1.0, 1.0, 9)
_PROFILE = 65  # points from the axis to the rim
_LEAD = 0.3  # of the distance from front vertex to film: where rays begin before the lens
_LAST_LIGHT = 0.97


@dataclass(frozen=True, eq=False)
class SectionRay:
    """A ray in the plane of the section.

    Attributes:
        points_mm: ``(m, 2)`` z and y of where it is bent, from before the lens to the film or to the rim that blocks it.
        blocked: whether a rim does.
    """

    points_mm: DoubleArray
    blocked: bool


@dataclass(frozen=True, eq=False)
class SectionBeam:
    """The rays of one point in the plane of focus.

    Attributes:
        height_mm: of the image.
        angle_deg: of the chief ray in object space.
        rays: evenly over the stop.
    """

    height_mm: float
    angle_deg: float
    rays: tuple[SectionRay, ...]


@dataclass(frozen=True, eq=False)
class LensSection:
    """A lens cut along its axis.

    Attributes:
        glasses: outline of each element, ``(m, 2)`` z and y, closed, and its refractive index; none for an ideal lens.
        stop_mm: z and radius of the opening.
        film_mm: z and half the height that light reaches on it.
        beams: of `BEAM_FIELDS`.
        rim_mm: largest radius of the lens.
    """

    glasses: tuple[tuple[DoubleArray, float], ...]
    stop_mm: tuple[float, float]
    film_mm: tuple[float, float]
    beams: tuple[SectionBeam, ...]
    rim_mm: float


def lens_section(camera: Camera, *, sideways: bool = False) -> LensSection:
    """The section of a camera's lens, focused and stopped down as it is.

    Args:
        camera: with its lens.
        sideways: cut a lens with cylinders from side to side in place of from top to bottom.

    Raises:
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance.
    """
    corner = float(np.hypot(camera.horizontal_aperture_mm, camera.vertical_aperture_mm)) / 2
    if not has_surfaces(camera):
        return _of_ideal(camera, corner)
    lens = mount_lens(camera)
    if not camera.lens.has_cylinders:
        return _of_glass(camera, lens, corner)
    if sideways:
        lens = replace(lens, prescription=turned(lens.prescription))
        return _of_glass(camera, lens, camera.horizontal_aperture_mm / (2 * camera.lens.squeeze))
    return _of_glass(camera, lens, camera.vertical_aperture_mm / 2)


def _of_glass(camera: Camera, lens: FocusedLens, corner: float) -> LensSection:
    rays = GlassRays(lens, focus_w(camera))
    lit = min(corner, _LAST_LIGHT * image_circle_mm(rays, 1.05 * corner) / 2)
    heights = np.array(BEAM_FIELDS) * lit
    surfaces = lens.prescription.surfaces
    return LensSection(
        tuple(
            (_outline(lens, i), surface.glass.index)
            for i, surface in enumerate(surfaces[:-1])
            if surface.glass.index != 1
        ),
        (float(lens.vertices_mm[lens.stop]), lens.stop_radius_mm),
        (lens.film_mm, lit),
        tuple(
            SectionBeam(float(height), float(np.degrees(np.arctan(slope))), fan)
            for height, slope, fan in zip(heights, rays.seen(heights), _fans(rays, lens, heights, camera), strict=True)
        ),
        max(surface.semi_diameter_mm for surface in surfaces),
    )


def _outline(lens: FocusedLens, i: int) -> DoubleArray:
    """The element behind surface i: both surfaces out to the wider one's rim.

    Beyond its own clear diameter a surface goes on flat, as elements are turned; where that would leave no glass it goes on
    curved, and where that leaves none either the element ends.
    """
    front, rear = lens.prescription.surfaces[i : i + 2]
    thickness = lens.prescription.surfaces[i].thickness_mm
    y = np.linspace(0.0, max(front.semi_diameter_mm, rear.semi_diameter_mm), _PROFILE)
    for curved in (False, True):
        z_front, z_rear = _profile(front, y, curved), thickness + _profile(rear, y, curved)
        no_glass = ~(z_rear >= z_front)
        if not no_glass.any():
            break
    end = max(int(np.argmax(no_glass)), 2) if no_glass.any() else len(y)
    z, up = float(lens.vertices_mm[i]) + np.stack([z_front, z_rear])[:, :end], y[:end]
    upward, downward = (
        np.stack([np.concatenate([side[::-1], side]), np.concatenate([-up[::-1], up])], axis=1) for side in z
    )
    return np.concatenate([upward, downward[::-1]])


def _profile(surface: Surface, y_mm: DoubleArray, curved: bool) -> DoubleArray:
    """Sag ``(m,)`` at heights; beyond the clear diameter it stays as at the rim, or curves on; NaN where it ends."""
    reach = y_mm if curved else np.minimum(y_mm, surface.semi_diameter_mm)
    return sag_mm(surface, reach**2)


def _fans(rays: GlassRays, lens: FocusedLens, heights: DoubleArray, camera: Camera) -> list[tuple[SectionRay, ...]]:
    pupil = np.stack([0 * _FAN, _FAN], axis=1)
    aimed, _ = rays.aim(radial(rays, heights), pupil, D_LINE_NM, focus_w(camera) / 1000)
    traced = trace_aimed(lens, aimed, D_LINE_NM, clip=True)
    before = float(lens.vertices_mm[0]) - _LEAD * (lens.film_mm - float(lens.vertices_mm[0]))
    start = aimed.points_mm + ((before - aimed.points_mm[:, 2]) / aimed.directions[:, 2])[:, None] * aimed.directions
    film = traced.at(lens.film_mm)
    found: list[tuple[SectionRay, ...]] = []
    for field in np.arange(len(heights) * len(_FAN)).reshape(len(heights), -1):
        fan = []
        for k in field[aimed.solved[field]]:
            blocker = int(traced.stopped_by[k])
            met = traced.points_mm[: blocker + 1 if blocker != PASSES else None, k]
            points = np.concatenate([start[k : k + 1], met])[:, [2, 1]]
            if blocker == PASSES:
                points = np.concatenate([points, [[lens.film_mm, film[k, 1]]]])
            fan.append(SectionRay(points[np.isfinite(points).all(axis=1)], blocker != PASSES))
        found.append(tuple(fan))
    return found


def _of_ideal(camera: Camera, corner: float) -> LensSection:
    """Straight to the pupil, and straight to the image, which errors of a kind move."""
    focal, radius = camera.focal_length_mm, camera.focal_length_mm / (2 * camera.f_stop) if camera.f_stop else 0.0
    rays, heights = film_rays(camera), np.array(BEAM_FIELDS) * corner
    fan = _FAN if radius else np.zeros(1)
    landing = rays.beams(radial(rays, heights), np.stack([0 * fan, fan], axis=1), D_LINE_NM).landing_mm[..., 1]
    beams = []
    for height, slope, ends in zip(heights, rays.seen(heights), landing, strict=True):
        y = radius * fan
        before = y + _LEAD * focal * (slope - y * focus_w(camera) / 1000)
        drawn = (
            np.array([[-_LEAD * focal, b], [0.0, m], [focal, -e]]) for b, m, e in zip(before, y, ends, strict=True)
        )
        angle = float(np.degrees(np.arctan(slope)))
        beams.append(SectionBeam(float(height), angle, tuple(SectionRay(points, False) for points in drawn)))
    return LensSection((), (0.0, radius), (focal, corner), tuple(beams), max(radius, 0.3 * corner))
