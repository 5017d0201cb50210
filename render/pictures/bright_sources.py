"""What is bright enough before a lens to be seen reflected in it: highlights, and lights that no geometry stands for.

It is looked for in a small picture of the scene, all of it sharp and wider than the film's, since a lens is also lit from beside
its picture. What lies farther outside, a lens hood shades.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from render.engines import sharp_engine
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import THIN_LENS
from render.model.scene import Light, Scene
from render.optics.flare.ghost_sheets import Source
from render.optics.view import PinholeView

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import FrameRenderer, FrameSettings

BRIGHT = 2.0
"""Radiance on the film, over what it shows white: here half of it flares, from one and a half times as much on all of it."""
MOST = 16
"""So many sources count, the strongest."""
_WIDER = 1.6  # than the picture
_WIDTH_PX, _CELL_PX = 480, 8
_RAYS = 8
_LUMINANCE = np.array([0.2722, 0.6741, 0.0537])  # Y of ACEScg's primaries (Academy S-2014-004)
_WIDEST_RAD = np.radians(2.0)  # half the angle of a light that is still like a point: ghosts of wider ones run together
_HIDDEN = 0.02  # share of its distance that something stands before a light to hide it, besides three times its radius


def bright_sources(renderer: FrameRenderer, scene: Scene, camera: Camera, settings: FrameSettings) -> list[Source]:
    """What flares in a picture, the strongest first.

    Args:
        renderer: of the calling thread.
        scene: what is there.
        camera: what looks; its exposure says what is bright.
        settings: of the picture; its shading and seed are kept.

    Raises:
        CameraError: the camera's numbers make no picture.
        GraphicsError: the device refuses.
    """
    height = max(1, round(_WIDTH_PX * settings.height / settings.width))
    around = replace(
        camera,
        horizontal_aperture_mm=camera.horizontal_aperture_mm * _WIDER,
        vertical_aperture_mm=camera.vertical_aperture_mm * _WIDER,
        f_stop=0.0,
        lens=THIN_LENS,
        focal_surface=None,
        breathing=False,
    )
    how = replace(
        settings,
        width=_WIDTH_PX,
        height=height,
        engine=sharp_engine(),
        rays=_RAYS,
        layers=1,
        motion=1,
        aovs=("color", "depth"),
    )
    frame = renderer.render(scene, around, how)
    seen = _Seen(PinholeView.from_camera(around, _WIDTH_PX, height), frame.color[..., :3], frame.aovs["depth"])
    highlights = _highlights(seen, BRIGHT / camera.exposure_scale) if camera.exposure_scale > 0 else []
    lights = [] if settings.shading == "unlit" else [_light_source(light, seen) for light in scene.lights]
    return _strongest(_together(highlights, [light for light in lights if light is not None], seen))


@dataclass(frozen=True, eq=False)
class _Seen:
    """The picture in which sources are looked for.

    Attributes:
        view: of it.
        radiance: ``(height, width, 3)``.
        depth_m: ``(height, width)``.
    """

    view: PinholeView
    radiance: FloatArray
    depth_m: FloatArray


def _highlights(seen: _Seen, bright: float) -> list[Source]:
    """The highlights, gathered in cells of the picture; each lies where its light has its centre."""
    view = seen.view
    radiance = np.asarray(seen.radiance, np.float64)
    level = (radiance @ _LUMINANCE) / bright
    x, y = np.meshgrid(_slopes(view.width, view.cx, view.fx), -_slopes(view.height, view.cy, view.fy))
    # A pixel's area in slopes, as the plane of the pupil sees it from the side: the square of cos²θ.
    light = radiance * (np.clip(level - 0.5, 0.0, 1.0) / (view.fx * view.fy * (1 + x**2 + y**2) ** 2))[..., None]
    is_near = np.isfinite(seen.depth_m) & (seen.depth_m > 0)  # at an edge, the pixel's middle may see past what glows
    nearness = np.divide(1.0, seen.depth_m, out=np.zeros_like(x), where=is_near)
    weight = light @ _LUMINANCE
    cells = [_in_cells(weight * what) for what in (np.ones_like(x), x, y, nearness, is_near)]
    colours = np.stack([_in_cells(light[..., channel]) for channel in range(3)], axis=-1)
    total = cells[0]
    return [
        Source(
            (float(cells[1][place] / total[place]), float(cells[2][place] / total[place])),
            colours[place],
            float(cells[4][place] / cells[3][place]) if cells[3][place] > 0 else float("inf"),
        )
        for place in zip(*np.nonzero(total > 0), strict=True)
    ]


def _slopes(count: int, centre: float, focal: float) -> DoubleArray:
    return np.asarray((np.arange(count) + 0.5 - centre) / focal, np.float64)


def _in_cells(values: DoubleArray) -> DoubleArray:
    """Sums over square cells of the picture."""
    rows, columns = (-side % _CELL_PX for side in values.shape)
    padded = np.pad(values, ((0, rows), (0, columns)))
    return np.asarray(
        padded.reshape(padded.shape[0] // _CELL_PX, _CELL_PX, padded.shape[1] // _CELL_PX, _CELL_PX).sum(axis=(1, 3))
    )


def _light_source(light: Light, seen: _Seen) -> Source | None:
    """A light as the lens sees it; None where it does not."""
    camera_from_light = seen.view.camera_from_world @ light.pose
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
    if _radius_m(light) > _WIDEST_RAD * distance_m or not _is_in_sight(seen, slope, depth_m, light.radius_m):
        return None
    irradiance = np.array(light.radiance) * _solid_angle(light, toward, camera_from_light, distance_m) * -toward[2]
    return Source((float(slope[0]), float(slope[1])), irradiance, depth_m)


def _radius_m(light: Light) -> float:
    """Of the smallest circle around it; 0 for one that has an angle and no size."""
    return float(np.hypot(light.width_m, light.height_m)) / 2 if light.kind == "rect" else light.radius_m


def _solid_angle(light: Light, toward: DoubleArray, camera_from_light: DoubleArray, distance_m: float) -> float:
    """What a light's radiance is multiplied by: the angle that it fills as it is turned, none beyond its cone."""
    if light.kind == "distant":
        return 1.0  # it is known by its irradiance
    turned = float(toward @ camera_from_light[:3, 2])  # it shines along its -Z
    if light.cone_angle_rad < np.pi and turned < np.cos(light.cone_angle_rad):
        return 0.0
    if light.kind == "sphere":
        return float(np.pi * min(light.radius_m / distance_m, 1.0) ** 2)
    area_m2 = np.pi * light.radius_m**2 if light.kind == "disk" else light.width_m * light.height_m
    return float(area_m2 * max(turned, 0.0) / distance_m**2)


def _is_in_sight(seen: _Seen, slope: DoubleArray, depth_m: float, radius_m: float) -> bool:
    """Whether a place lies in the picture, and nothing stands before it."""
    view = seen.view
    x, y = view.cx + view.fx * slope[0], view.cy - view.fy * slope[1]
    if not (0 <= x < view.width and 0 <= y < view.height):
        return False
    first_m = float(seen.depth_m[int(y), int(x)])
    return not first_m < (depth_m - 3 * radius_m) * (1 - _HIDDEN)


def _together(highlights: list[Source], lights: list[Source], seen: _Seen) -> list[Source]:
    """Highlights and lights. Glowing geometry around a light is the same source, and the brighter of the two counts: a light
    shines on the lens as it does on everything, whatever its lamp looks like."""
    reach = 1.5 * _CELL_PX / seen.view.fx
    for light in lights:
        around = [h for h in highlights if np.hypot(h.slope[0] - light.slope[0], h.slope[1] - light.slope[1]) < reach]
        if sum(float(h.irradiance @ _LUMINANCE) for h in around) < float(light.irradiance @ _LUMINANCE):
            highlights = [h for h in highlights if h not in around]
            highlights.append(light)
    return highlights


def _strongest(sources: list[Source]) -> list[Source]:
    """The strongest, which fade where they are hardly stronger than what is left out, so that none comes or goes at once."""
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
