"""Sources bright enough to be seen reflected in a lens: highlights, and lights without geometry.

They are found in a small sharp picture of the scene. It is wider than the film's, since a lens is also lit from beside its
picture; what lies farther outside is shaded by a lens hood.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from render.engines import sharp_engine
from render.layers.lights import area_m2
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import THIN_LENS
from render.model.scene import Light, Scene
from render.optics.flare.ghost_sheets import Source
from render.optics.view import PinholeView

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import FrameRenderer, FrameSettings

BRIGHT = 2.0
"""Radiance on the film, over its white, of which half flares; at one and a half times this, all of it does."""
MOST = 16
"""Number of sources that are kept, the strongest."""
_WIDER = 1.6  # width of the picture that is searched, over that of the film
_WIDTH_PX, _CELL_PX = 480, 8
_RAYS = 8
_LUMINANCE = np.array([0.2722, 0.6741, 0.0537])  # Y of ACEScg's primaries (Academy S-2014-004)
_WIDEST_RAD = np.radians(2.0)  # half angle of a light that is like a point; the ghosts of wider lights run together
_HIDDEN = 0.02  # share of a light's distance, besides three radii, by which a surface in front hides it


def find_bright_sources(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings) -> list[Source]:
    """Find the sources that flare in a picture, the strongest first.

    Args:
        renderer: of the calling thread.
        scene: the scene.
        camera: the camera; its exposure decides what is bright.
        settings: of the picture; shading and seed are kept.

    Raises:
        CameraError: the camera's values cannot make a picture.
        GraphicsError: OpenGL reports an error.
    """
    height = max(1, round(_WIDTH_PX * settings.height / settings.width))
    wide_camera = replace(
        camera,
        horizontal_aperture_mm=camera.horizontal_aperture_mm * _WIDER,
        vertical_aperture_mm=camera.vertical_aperture_mm * _WIDER,
        f_stop=0.0,
        lens=THIN_LENS,
        focal_surface=None,
        breathing=False,
    )
    search = replace(
        settings,
        width=_WIDTH_PX,
        height=height,
        engine=sharp_engine(),
        rays=_RAYS,
        layers=1,
        motion=1,
        aovs=("color", "depth"),
    )
    frame = renderer.render(scene, wide_camera, search)
    picture = _SearchPicture(
        PinholeView.from_camera(wide_camera, _WIDTH_PX, height), frame.color[..., :3], frame.aovs["depth"]
    )
    highlights = _find_highlights(picture, BRIGHT / camera.exposure_scale) if camera.exposure_scale > 0 else []
    lights = [] if settings.shading == "unlit" else [_light_source(light, picture) for light in scene.lights]
    return _keep_strongest(_merge(highlights, [light for light in lights if light is not None], picture))


@dataclass(frozen=True, eq=False)
class _SearchPicture:
    """The picture that is searched.

    Attributes:
        view: its projection.
        radiance: ``(height, width, 3)``.
        depth_m: ``(height, width)``.
    """

    view: PinholeView
    radiance: FloatArray
    depth_m: FloatArray


def _find_highlights(picture: _SearchPicture, bright: float) -> list[Source]:
    """Gather the highlights in cells of the picture; each source lies at the centroid of its light."""
    view = picture.view
    radiance = np.asarray(picture.radiance, np.float64)
    level = (radiance @ _LUMINANCE) / bright
    x, y = np.meshgrid(_slopes(view.width, view.cx, view.fx), -_slopes(view.height, view.cy, view.fy))
    # A pixel's area in slopes times the cosines of emission and incidence at the pupil's plane: (cos²θ)².
    light = radiance * (np.clip(level - 0.5, 0.0, 1.0) / (view.fx * view.fy * (1 + x**2 + y**2) ** 2))[..., None]
    is_near = np.isfinite(picture.depth_m) & (picture.depth_m > 0)  # at an edge the pixel's centre may miss what glows
    nearness = np.divide(1.0, picture.depth_m, out=np.zeros_like(x), where=is_near)
    weight = light @ _LUMINANCE
    cells = [_sum_cells(weight * values) for values in (np.ones_like(x), x, y, nearness, is_near)]
    colours = np.stack([_sum_cells(light[..., channel]) for channel in range(3)], axis=-1)
    total = cells[0]
    return [
        Source(
            (float(cells[1][cell] / total[cell]), float(cells[2][cell] / total[cell])),
            colours[cell],
            float(cells[4][cell] / cells[3][cell]) if cells[3][cell] > 0 else float("inf"),
        )
        for cell in zip(*np.nonzero(total > 0), strict=True)
    ]


def _slopes(count: int, centre: float, focal: float) -> DoubleArray:
    return np.asarray((np.arange(count) + 0.5 - centre) / focal, np.float64)


def _sum_cells(values: DoubleArray) -> DoubleArray:
    """Sum over square cells of the picture."""
    rows, columns = (-side % _CELL_PX for side in values.shape)
    padded = np.pad(values, ((0, rows), (0, columns)))
    return np.asarray(
        padded.reshape(padded.shape[0] // _CELL_PX, _CELL_PX, padded.shape[1] // _CELL_PX, _CELL_PX).sum(axis=(1, 3))
    )


def _light_source(light: Light, picture: _SearchPicture) -> Source | None:
    """Make the source of a light; None where the lens does not see it."""
    camera_from_light = picture.view.camera_from_world @ light.pose
    if light.kind == "distant":
        toward, distance_m = camera_from_light[:3, 2], np.inf
    else:
        toward = camera_from_light[:3, 3]
        distance_m = float(np.linalg.norm(toward))
        toward = toward / max(distance_m, 1e-9)
    if toward[2] >= -1e-6:
        return None
    slope = -toward[:2] / toward[2]
    depth_m = float(distance_m * -toward[2])
    if _radius_m(light) > _WIDEST_RAD * distance_m or not _is_in_sight(picture, slope, depth_m, light.radius_m):
        return None
    irradiance = np.array(light.radiance) * _solid_angle(light, toward, camera_from_light, distance_m) * -toward[2]
    return Source((float(slope[0]), float(slope[1])), irradiance, depth_m)


def _radius_m(light: Light) -> float:
    """Radius of the smallest circle around a light; 0 for a distant light."""
    if light.kind == "cylinder":
        return float(np.hypot(light.radius_m, light.length_m / 2))
    return float(np.hypot(light.width_m, light.height_m)) / 2 if light.kind == "rect" else light.radius_m


def _solid_angle(light: Light, toward: DoubleArray, camera_from_light: DoubleArray, distance_m: float) -> float:
    """Solid angle that a light fills, foreshortened, in steradians; 0 beyond its cone, 1 for a distant light."""
    if light.kind == "distant":
        return 1.0  # its radiance is an irradiance
    turned = float(toward @ camera_from_light[:3, 2])  # it shines along its -Z
    if light.cone_angle_rad < np.pi and turned < np.cos(light.cone_angle_rad):
        return 0.0
    if light.kind == "sphere":
        return float(np.pi * min(light.radius_m / distance_m, 1.0) ** 2)
    if light.triangles is not None:
        return area_m2(light) / distance_m**2  # as a ball, which shows a quarter of its area
    if light.kind == "cylinder":
        across = float(np.linalg.norm(np.cross(toward, camera_from_light[:3, 0])))  # its side shines
        return 2 * light.radius_m * light.length_m * across / distance_m**2
    return area_m2(light) * max(turned, 0.0) / distance_m**2


def _is_in_sight(picture: _SearchPicture, slope: DoubleArray, depth_m: float, radius_m: float) -> bool:
    """True where a place lies in the picture and no surface hides it."""
    view = picture.view
    x, y = view.cx + view.fx * slope[0], view.cy - view.fy * slope[1]
    if not (0 <= x < view.width and 0 <= y < view.height):
        return False
    first_m = float(picture.depth_m[int(y), int(x)])
    return not first_m < (depth_m - 3 * radius_m) * (1 - _HIDDEN)


def _merge(highlights: list[Source], lights: list[Source], picture: _SearchPicture) -> list[Source]:
    """Merge highlights and lights. Glowing geometry around a light is the same source, and the brighter of the two is kept: a
    light shines on the lens as it does on everything, whatever its lamp looks like."""
    reach = 1.5 * _CELL_PX / picture.view.fx
    for light in lights:
        around = [h for h in highlights if np.hypot(h.slope[0] - light.slope[0], h.slope[1] - light.slope[1]) < reach]
        if sum(float(h.irradiance @ _LUMINANCE) for h in around) < float(light.irradiance @ _LUMINANCE):
            highlights = [h for h in highlights if h not in around]
            highlights.append(light)
    return highlights


def _keep_strongest(sources: list[Source]) -> list[Source]:
    """Keep the strongest. Those hardly stronger than the first that is left out are dimmed, so that none appears at once."""
    ordered = sorted(sources, key=lambda source: -float(source.irradiance @ _LUMINANCE))
    kept = [source for source in ordered[:MOST] if source.irradiance @ _LUMINANCE > 0]
    if len(ordered) <= MOST:
        return kept
    least = float(ordered[MOST].irradiance @ _LUMINANCE)
    share = [min(float(source.irradiance @ _LUMINANCE) / max(least, 1e-30) - 1.0, 1.0) for source in kept]
    return [
        replace(source, irradiance=source.irradiance * part)
        for source, part in zip(kept, share, strict=True)
        if part > 0
    ]
