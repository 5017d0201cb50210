"""UsdLux lights in physical terms.

UsdLux: radiance = colour · intensity · 2^exposure, divided by the light's area where ``normalize`` is set. That area is in
scene units, as in USD's reference renderer (hdEmbree), so that a shot keeps its exposure whatever its metersPerUnit.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from pxr import Sdf, Usd, UsdGeom, UsdLux

from render import colour
from render.errors import InputError
from render.model.arrays import DoubleArray, FloatArray
from render.model.scene import POINT_RADIUS_M, Dome, Image, Light
from render.stage.assembly.poses import is_hidden, world_pose
from render.stage.color_spaces import rgb_to_working, space_of, to_rec709
from render.stage.dome_formats import FORMATS, latlong_image
from render.stage.findings import FindingLog
from render.stage.geometry.skinning import Skeletons
from render.stage.light_filters import FilterReader, saturate
from render.stage.limits import PlaceError
from render.stage.materials.image_files import TextureError
from render.stage.materials.textures import TextureCache
from render.stage.mesh_lights import shining_prims, shining_triangles
from render.stage.opening import confinement
from render.stage.photometry import ProfileError, read_profile
from render.stage.values import UNREADABLE, schema_type, why_unreadable
from render.stage.world import is_y_up, rigid_frame, world_from_stage

RGB = tuple[float, float, float]
_DOMES = ("DomeLight", "DomeLight_1")
# Beyond these a light's power overflows single precision; the sun's disc has a radiance of 2e9 nits and a radius of 7e8 m.
_MAX_RADIANCE = 1e18
_MAX_MEASURE = 1e10
_MAX_FOCUS = 1e4
# +Z-up from +Y-up: the rotation of DomeLight_1's pole axis on a Z-up stage.
_Z_UP_FROM_Y_UP = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], np.float64)


class LightReader:
    """Reads the lights of a stage at a time.

    Args:
        stage: the stage.
        textures: reads dome textures.
        skeletons: bend meshes that shine.
        log: receives requests that are not honoured.
        complexity: of surfaces that shine (`render.stage.options.StageOptions`).
    """

    def __init__(
        self, stage: Usd.Stage, textures: TextureCache, skeletons: Skeletons, log: FindingLog, complexity: str
    ) -> None:
        self._stage, self._textures, self._log = stage, textures, log
        self._world = world_from_stage(stage)
        self._skeletons, self._complexity = skeletons, complexity
        self._filters = FilterReader(self._world, log)
        self._profiles: dict[tuple[str, float, bool], FloatArray] = {}
        self._converted: tuple[Image, str, Image] | None = None
        self._confined_to = confinement(stage)
        self._metres_per_unit = float(np.linalg.norm(self._world[:3, 0]))

    def read(
        self, lights: Sequence[tuple[Usd.Prim, tuple[Usd.Prim, ...]]], transforms: UsdGeom.XformCache
    ) -> tuple[tuple[Light, ...], Dome | None]:
        """The lights that are on at a time, and the dome.

        Args:
            lights: light prims, and with each the prims whose varying visibility may hide it.
            transforms: transforms at the time.
        """
        found: list[Light] = []
        dome: Dome | None = None
        for prim, hiders in lights:
            if is_hidden(hiders, transforms.GetTime()):
                continue
            path = prim.GetPath()
            try:
                if not self.is_dome(prim):
                    light = self.light(prim, transforms)
                    found.extend([light] if light is not None else [])
                elif dome is None:
                    dome = self.dome(prim, transforms)
                else:
                    message = f"dome light {path} is not honoured: {dome.path} is the one that shines"
                    self._log.add("second_dome", path, message)
            except PlaceError as problem:
                message = f"light {path} is off: the transform of {problem.path} is not finite"
                self._log.add("bad_light", path, message)
            except UNREADABLE as problem:
                self._log.add("bad_light", path, f"light {path} is off: {why_unreadable(problem)}")
        return tuple(found), dome

    def is_dome(self, prim: Usd.Prim) -> bool:
        """Whether a light prim lights from all around."""
        return schema_type(prim) in _DOMES

    def light(self, prim: Usd.Prim, transforms: UsdGeom.XformCache) -> Light | None:
        """A light with a place or a direction, or None (and a finding) where its kind is not honoured."""
        readers: dict[str, Callable[[Usd.Prim, DoubleArray, UsdGeom.XformCache], Light | None]] = {
            "DistantLight": self._distant,
            "SphereLight": self._sphere,
            "DiskLight": self._disk,
            "RectLight": self._rect,
            "CylinderLight": self._cylinder,
            "GeometryLight": self._mesh,
        }
        path, kind = prim.GetPath(), schema_type(prim)
        reader = self._mesh if prim.HasAPI(UsdLux.MeshLightAPI) else readers.get(kind)
        if kind == "PortalLight":
            return None  # guides the sampling of a dome, which needs none
        if reader is None:
            what = "a volume that shines" if prim.HasAPI(UsdLux.VolumeLightAPI) else kind or "its kind"
            self._log.add("unsupported_light", path, f"light {path} is not honoured: {what} is not supported")
            return None
        light, peak = reader(prim, world_pose(prim, transforms, self._world), transforms), 1.0
        if light is not None and prim.GetRelationship("light:filters").HasAuthoredTargets():
            filtering = self._filters.read(prim, transforms)
            light = replace(
                light,
                radiance=saturate(light.radiance, filtering.saturation),
                diffuse=light.diffuse * filtering.diffuse,
                specular=light.specular * filtering.specular,
                filters=filtering.filters,
            )
            peak = filtering.peak
            if light.image is not None and filtering.saturation != 1:
                message = f"light {path} is textured: its filters' saturation acts on its color, not on its texture"
                self._log.add("unsupported_filter", path, message)
        measures = (light.radius_m, light.width_m, light.height_m, light.length_m, light.angle_rad) if light else ()
        if light is not None and not _in_range(
            light.radiance, (peak * light.diffuse, peak * light.specular), *measures
        ):
            self._log.add("bad_light", path, f"light {path} is off: its numbers are out of range")
            return None
        return light

    def dome(self, prim: Usd.Prim, transforms: UsdGeom.XformCache) -> Dome:
        """A dome light."""
        time = transforms.GetTime()
        # The dome's axes are the stage's; it depends on directions alone, so units and scale drop out.
        pose = rigid_frame(world_pose(prim, transforms, self._world))
        pose[:3, 3] = 0.0
        if schema_type(prim) == "DomeLight_1" and self._pole_is_z(prim, time):
            pose = pose @ _Z_UP_FROM_Y_UP
        radiance = _radiance(prim, time, self._log)
        diffuse, specular = (_number(prim, f"inputs:{name}", time) for name in ("diffuse", "specular"))
        path = str(prim.GetPath())
        if prim.GetRelationship("light:filters").HasAuthoredTargets():
            filtering = self._filters.read(prim, transforms)
            diffuse, specular = diffuse * filtering.diffuse, specular * filtering.specular
            if filtering.filters or filtering.saturation != 1:
                message = f"dome {path} is filtered as a whole: barn doors, ramps and saturation are not honoured"
                self._log.add("unsupported_filter", path, message)
        if not _in_range(radiance, (diffuse, specular)):
            self._log.add("bad_light", path, f"light {path} is off: its numbers are out of range")
            radiance, diffuse, specular = (0.0, 0.0, 0.0), 0.0, 0.0
        return Dome(radiance, pose, self._dome_image(prim, time), diffuse=diffuse, specular=specular, path=path)

    def _pole_is_z(self, prim: Usd.Prim, time: Usd.TimeCode) -> bool:
        axis = prim.GetAttribute("poleAxis").Get(time)
        return bool(axis == "Z" or (axis == "scene" and not is_y_up(self._stage)))

    def _dome_image(self, prim: Usd.Prim, time: Usd.TimeCode) -> Image | None:
        path = prim.GetPath()
        layout = str(prim.GetAttribute("inputs:texture:format").Get(time))
        if layout not in ("automatic", "latlong", *FORMATS) and _texture(prim, time) is not None:
            self._log.add("dome_format", path, f"dome {path} is uniform: USD knows no texture format {layout}")
            return None
        image = self._image(prim, time, f"dome texture {{}}; dome {path} is uniform")
        if image is None or layout not in FORMATS:
            return image
        if self._converted is None or self._converted[:2] != (image, layout):
            self._converted = image, layout, latlong_image(image, layout)
        return self._converted[2]

    def _image(self, prim: Usd.Prim, time: Usd.TimeCode, message: str) -> Image | None:
        """Image that a light names; None, and a finding by ``message``, where it cannot be read."""
        asset = _texture(prim, time)
        if asset is None:
            return None
        attribute = prim.GetAttribute("inputs:texture:file")
        space = space_of(attribute) if attribute.HasColorSpace() else "auto"
        try:
            return self._textures.image(str(asset.resolvedPath), space)
        except (TextureError, InputError) as problem:
            self._log.add("texture_unreadable", prim.GetPath(), message.format(f"{asset.path} {problem}"))
            return None

    def _distant(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light:
        time = transforms.GetTime()
        angle = float(np.radians(max(_number(prim, "inputs:angle", time), 0.0)))
        # Irradiance of a disc of sky of that angle. Normalised, or without an angle, intensity is the irradiance itself.
        solid = np.pi * np.sin(min(angle, np.pi) / 2) ** 2
        factor = 1.0 if _flag(prim, "inputs:normalize", time) or angle == 0 else float(solid)
        return self._light(prim, "distant", pose, time, factor, angle_rad=angle)

    def _sphere(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light | None:
        time = transforms.GetTime()
        radius_m = _number(prim, "inputs:radius", time) * float(np.mean(_scales(pose)))
        return self._round(prim, "sphere", pose, time, radius_m, 4 * np.pi)

    def _disk(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light | None:
        time = transforms.GetTime()
        radius_m = _number(prim, "inputs:radius", time) * float(np.mean(_scales(pose)[:2]))
        return self._round(prim, "disk", pose, time, radius_m, np.pi)

    def _round(
        self, prim: Usd.Prim, kind: str, pose: DoubleArray, time: Usd.TimeCode, radius_m: float, area_factor: float
    ) -> Light | None:
        normalised = _flag(prim, "inputs:normalize", time)
        if radius_m <= 0 and not normalised:
            path = prim.GetPath()
            self._log.add("light_without_area", path, f"light {path} is dark: its radius is 0 and it is not normalised")
            return None
        radius_m = max(radius_m, POINT_RADIUS_M)
        factor = 1 / (area_factor * (radius_m / self._metres_per_unit) ** 2) if normalised else 1.0
        return self._light(prim, kind, pose, time, factor, radius_m=radius_m)

    def _rect(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light | None:
        time = transforms.GetTime()
        scales, path = _scales(pose), prim.GetPath()
        width_m = _number(prim, "inputs:width", time) * float(scales[0])
        height_m = _number(prim, "inputs:height", time) * float(scales[1])
        if width_m <= 0 or height_m <= 0:
            self._log.add("light_without_area", path, f"light {path} is dark: its width or height is 0")
            return None
        area = width_m * height_m / self._metres_per_unit**2
        factor = 1 / area if _flag(prim, "inputs:normalize", time) else 1.0
        light = self._light(prim, "rect", pose, time, factor, width_m=width_m, height_m=height_m)
        return replace(light, image=self._image(prim, time, f"texture {{}}; light {path} shines evenly"))

    def _cylinder(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light | None:
        time = transforms.GetTime()
        scales, path = _scales(pose), prim.GetPath()
        length_m = _number(prim, "inputs:length", time) * float(scales[0])
        radius_m = _number(prim, "inputs:radius", time) * float(np.mean(scales[1:]))
        normalised = _flag(prim, "inputs:normalize", time)
        if length_m <= 0 or (radius_m <= 0 and not normalised):
            which = "radius is 0 and it is not normalised" if length_m > 0 else "length is 0"
            self._log.add("light_without_area", path, f"light {path} is dark: its {which}")
            return None
        radius_m = max(radius_m, POINT_RADIUS_M)
        area = 2 * np.pi * radius_m * length_m / self._metres_per_unit**2  # its ends are dark
        factor = 1 / area if normalised else 1.0
        return self._light(prim, "cylinder", pose, time, factor, radius_m=radius_m, length_m=length_m)

    def _mesh(self, prim: Usd.Prim, pose: DoubleArray, transforms: UsdGeom.XformCache) -> Light | None:
        time, path = transforms.GetTime(), prim.GetPath()
        placed = [(shining, world_pose(shining, transforms, self._world)) for shining in shining_prims(prim)]
        triangles = shining_triangles(placed, time, self._skeletons, self._log, self._complexity)
        middles = triangles.mean(1)
        areas = (
            np.linalg.norm(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1) / 2
        )
        if not areas.sum() > 0:
            self._log.add("light_without_area", path, f"light {path} is dark: it has no surface")
            return None
        middle = np.average(middles, axis=0, weights=areas)
        place = np.eye(4)
        place[:3, 3] = middle
        radius_m = float(np.linalg.norm(triangles - middle, axis=2).max())
        area = float(areas.sum()) / self._metres_per_unit**2
        factor = 1 / area if _flag(prim, "inputs:normalize", time) else 1.0
        return replace(self._light(prim, "mesh", place, time, factor, radius_m=radius_m), triangles=triangles)

    def _profile(self, prim: Usd.Prim, time: Usd.TimeCode) -> FloatArray | None:
        """Photometry that a light names; None, and a finding, where it cannot be read."""
        asset = prim.GetAttribute("inputs:shaping:ies:file").Get(time)
        if not isinstance(asset, Sdf.AssetPath) or not asset.path:
            return None
        file, scale = str(asset.resolvedPath), _number(prim, "inputs:shaping:ies:angleScale", time)
        key = (file, scale if np.isfinite(scale) else 0.0, _flag(prim, "inputs:shaping:ies:normalize", time))
        try:
            if key not in self._profiles:
                self._profiles[key] = read_profile(file, self._confined_to, key[1], normalize=key[2])
            return self._profiles[key]
        except ProfileError as problem:
            path = prim.GetPath()
            message = f"IES file {asset.path} {problem}; light {path} shines as without it"
            self._log.add("bad_profile", path, message)
            return None

    def _shadow_limits(self, prim: Usd.Prim, time: Usd.TimeCode) -> dict[str, float]:
        """Fields of a `Light` that end its shadows; none where ``distance`` is negative, as by default: they reach anywhere."""
        reach = _number(prim, "inputs:shadow:distance", time)
        if not prim.HasAPI(UsdLux.ShadowAPI) or not 0 <= reach <= _MAX_MEASURE:
            return {}
        fade, gamma = (_number(prim, name, time) for name in ("inputs:shadow:falloff", "inputs:shadow:falloffGamma"))
        return {
            "shadow_reach_m": reach * self._metres_per_unit,
            "shadow_fade_m": min(max(fade, 0.0), reach) * self._metres_per_unit,
            "shadow_gamma": min(max(gamma, 0.0), _MAX_FOCUS) if np.isfinite(gamma) else 1.0,
        }

    def _light(
        self, prim: Usd.Prim, kind: str, pose: DoubleArray, time: Usd.TimeCode, factor: float, **measures: float
    ) -> Light:
        red, green, blue = (channel * factor for channel in _radiance(prim, time, self._log))
        cone, softness = _cone(prim, time)
        shadow = prim.GetAttribute("inputs:shadow:enable")
        shaped = prim.HasAPI(UsdLux.ShapingAPI) and kind != "distant"
        return Light(
            kind=kind,  # type: ignore[arg-type]
            radiance=(red, green, blue),
            pose=rigid_frame(pose),
            cone_angle_rad=cone,
            cone_softness=softness,
            diffuse=_number(prim, "inputs:diffuse", time),
            specular=_number(prim, "inputs:specular", time),
            profile=self._profile(prim, time) if shaped else None,
            focus=min(max(_number(prim, "inputs:shaping:focus", time), 0.0), _MAX_FOCUS) if shaped else 0.0,
            focus_tint=_color(prim, "inputs:shaping:focusTint", time, self._log) if shaped else (0.0, 0.0, 0.0),
            casts_shadow=bool(shadow.Get(time)) if shadow else True,
            shadow_color=_color(prim, "inputs:shadow:color", time, self._log) if shadow else (0.0, 0.0, 0.0),
            path=str(prim.GetPath()),
            **measures,  # type: ignore[arg-type]
            **self._shadow_limits(prim, time),  # type: ignore[arg-type]
        )


def _radiance(prim: Usd.Prim, time: Usd.TimeCode, log: FindingLog) -> RGB:
    """colour · intensity · 2^exposure, with the colour temperature where it is enabled, in the working space; inf if too much."""
    attribute = prim.GetAttribute("inputs:color")
    color = to_rec709(np.array(attribute.Get(time), np.float32), attribute, log).astype(np.float64)
    if _flag(prim, "inputs:enableColorTemperature", time):
        kelvin = _number(prim, "inputs:colorTemperature", time)
        color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin), np.float64)
    strength = _number(prim, "inputs:intensity", time) * 2.0 ** _number(prim, "inputs:exposure", time)
    rgb = color * strength
    if not (np.abs(rgb) <= _MAX_RADIANCE).all():
        return np.inf, np.inf, np.inf
    return colour.rgb_to_working((float(rgb[0]), float(rgb[1]), float(rgb[2])))


def _color(prim: Usd.Prim, name: str, time: Usd.TimeCode, log: FindingLog) -> RGB:
    """A share of light in the working space; black where it is none."""
    value = prim.GetAttribute(name).Get(time)
    rgb = np.array(value if value is not None else (0, 0, 0), np.float64)
    if not (np.abs(rgb) <= _MAX_RADIANCE).all():
        return 0.0, 0.0, 0.0
    return rgb_to_working(rgb.tolist(), prim.GetAttribute(name), log)


def _texture(prim: Usd.Prim, time: Usd.TimeCode) -> Sdf.AssetPath | None:
    """Texture that a light names, or None."""
    asset = prim.GetAttribute("inputs:texture:file").Get(time)
    return asset if isinstance(asset, Sdf.AssetPath) and asset.path else None


def _cone(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[float, float]:
    """Half angle (radians) and softness of the shaping cone; pi where the light is not shaped."""
    if not prim.HasAPI(UsdLux.ShapingAPI):
        return float(np.pi), 0.0
    angle = float(np.radians(_number(prim, "inputs:shaping:cone:angle", time)))
    return min(angle, float(np.pi)), min(max(_number(prim, "inputs:shaping:cone:softness", time), 0.0), 1.0)


def _in_range(radiance: RGB, responses: tuple[float, float], *measures: float) -> bool:
    """Whether a light's numbers can be reckoned with in single precision, and so are finite at all.

    Args:
        radiance: of the light.
        responses: multipliers of its diffuse response and of its highlights.
        measures: lengths (m) and angles.
    """
    shining = (channel * response for channel in radiance for response in (1.0, *responses))
    return all(abs(number) <= _MAX_RADIANCE for number in (*shining, *responses)) and all(
        abs(measure) <= _MAX_MEASURE for measure in measures
    )


def _scales(pose: DoubleArray) -> NDArray[np.float64]:
    """Lengths of the axes: metres per unit of the light's own space."""
    lengths: NDArray[np.float64] = np.linalg.norm(pose[:3, :3], axis=0)
    return lengths


def _number(prim: Usd.Prim, name: str, time: Usd.TimeCode) -> float:
    attribute = prim.GetAttribute(name)
    value = attribute.Get(time) if attribute else None
    return float(value) if value is not None else 0.0


def _flag(prim: Usd.Prim, name: str, time: Usd.TimeCode) -> bool:
    attribute = prim.GetAttribute(name)
    return bool(attribute and attribute.Get(time))
