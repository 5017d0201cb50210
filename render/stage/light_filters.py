"""Light filters of a stage: RenderMan's, whose types and shader names stages use, since UsdLux has no kinds of its own.

Their parameters have the names of RenderMan's shaders (``inputs:width``), or those of OpenUSD's earlier schemas in usdRi
(``width``, ``edge:left``). Their documentation: RenderMan, "Light Filters"; OpenUSD 20.11, usdRi.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Tf, Usd, UsdGeom

from render import colour
from render.model.arrays import DoubleArray
from render.model.light_filters import RAMP_STEPS, Barn, LightFilter, PreBarn, Ramp, RampMode, Window
from render.stage.findings import FindingLog
from render.stage.values import UNREADABLE, schema_type, why_unreadable
from render.stage.world import column_matrix

_MOST = 1e9
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
_PRIMARIES = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_APEX = 25.0
_SIDES = ("left", "right", "bottom", "top")
_SPELLINGS = {
    "edge": ("edgeThickness",),
    "saturation": ("color:saturation",),
    "intensity": ("ri:intensity",),
    "preBarn": ("preBarnEffect",),
    "rampType": ("rampMode",),
    "beginDist": ("beginDistance",),
    "endDist": ("endDistance",),
    "scaleWidth": ("scale:width",),
    "scaleHeight": ("scale:height",),
    **{name: (f"analytic:{name}",) for name in ("apex", "directional", "shearX", "shearY", "useLightDirection")},
    **{side: (f"refine:{side}",) for side in _SIDES},
    **{f"{side}Edge": (f"edge:{side}",) for side in _SIDES},
    "falloff_Knots": ("falloff:spline:positions",),
    "falloff_Floats": ("falloff:spline:values",),
    "falloff_Interpolation": ("falloff:spline:interpolation",),
    "colorRamp_Knots": ("colorRamp:spline:positions",),
    "colorRamp_Colors": ("colorRamp:spline:values",),
    "colorRamp_Interpolation": ("colorRamp:spline:interpolation",),
}
"""Other names of parameters, beside ``inputs:`` and ``inputs:ri:`` before the name itself."""
_BARN_MODES = ("physical", "analytic")
_PRE_BARN: dict[str, PreBarn] = {"noEffect": "all", "cone": "cone", "noLight": "none"}
_RAMP_MODES: dict[str, RampMode] = {
    "distanceToLight": "distance",
    "linear": "linear",
    "spherical": "spherical",
    "radial": "radial",
}


@dataclass(frozen=True)
class Filtering:
    """Filters of a light.

    Attributes:
        filters: those that act by place.
        diffuse: multiplier of the light's diffuse response, by those that do not.
        specular: multiplier of its highlights.
        saturation: of its colour.
        peak: multiplier of light, at any place, by those that act by place: the greatest, without its sign.
    """

    filters: tuple[LightFilter, ...] = ()
    diffuse: float = 1.0
    specular: float = 1.0
    saturation: float = 1.0
    peak: float = 1.0


class FilterReader:
    """Reads the filters of lights.

    Args:
        world: ``(4, 4)`` world from stage.
        log: for findings.
    """

    def __init__(self, world: DoubleArray, log: FindingLog) -> None:
        self._world, self._log = world, log

    def read(self, light: Usd.Prim, transforms: UsdGeom.XformCache) -> Filtering:
        """The filters of a light at a time; what cannot be honoured is a finding, and left out.

        Args:
            light: its prim.
            transforms: transforms at the time.
        """
        relationship = light.GetRelationship("light:filters")
        targets = relationship.GetForwardedTargets() if relationship else []
        filters: list[LightFilter] = []
        diffuse = specular = saturation = peak = 1.0
        for path in targets:
            prim = light.GetStage().GetPrimAtPath(path)
            if not prim or not prim.IsActive():
                self._log.add(
                    "missing_target", path, f"light:filters of {light.GetPath()} names {path}, which is not there"
                )
                continue
            if _is_invisible(prim, transforms.GetTime()):
                continue
            settings = _Settings(prim, transforms.GetTime())
            try:
                kind = _kind(prim, settings)
                if kind == "PxrIntMultLightFilter":
                    own_diffuse, own_specular = _multipliers(settings)
                    diffuse, specular = diffuse * own_diffuse, specular * own_specular
                    saturation *= settings.number("saturation", 1.0)
                elif kind in ("PxrBarnLightFilter", "PxrRampLightFilter"):
                    pose = self._pose(prim, transforms)
                    if kind == "PxrRampLightFilter":
                        shape: Barn | Ramp = self._ramp(settings)
                    else:
                        place = np.linalg.solve(pose, self._place(light, transforms))
                        shape = _barn(settings, np.asarray(place, np.float64))
                    one = _filter(settings, shape, pose)
                    peak *= _peak(one)
                    filters.append(one)
                else:
                    raise ValueError(f"{kind or 'its kind'} is not supported")
            except (*UNREADABLE, Tf.ErrorException) as problem:
                why = str(problem) if isinstance(problem, ValueError) else why_unreadable(problem)
                self._log.add("unsupported_filter", path, f"light filter {path} is not honoured: {why}")
                continue
            self._note_unread(prim, settings)
        return Filtering(tuple(filters), diffuse, specular, max(saturation, 0.0), peak)

    def _pose(self, prim: Usd.Prim, transforms: UsdGeom.XformCache) -> DoubleArray:
        """World from the filter's own units. USD does not know the transform of a prim of a type that it does not know."""
        matrix = transforms.GetLocalToWorldTransform(prim)
        xformable = UsdGeom.Xformable(prim)
        if not xformable:
            matrix = xformable.GetLocalTransformation(transforms.GetTime())
            if not xformable.GetResetXformStack():
                matrix = matrix * transforms.GetLocalToWorldTransform(prim.GetParent())
        pose = np.asarray(self._world @ column_matrix(matrix))
        lengths = np.linalg.norm(pose[:3, :3], axis=0)
        if not np.isfinite(pose).all() or abs(np.linalg.det(pose[:3, :3])) <= 1e-6 * lengths.prod():
            raise ValueError("its transform is not finite, or flat")
        return pose

    def _place(self, light: Usd.Prim, transforms: UsdGeom.XformCache) -> DoubleArray:
        """World place ``(4,)`` of a light, or the direction towards it."""
        pose = self._world @ column_matrix(transforms.GetLocalToWorldTransform(light))
        return np.asarray(pose[:, 2] if schema_type(light) == "DistantLight" else pose[:, 3])

    def _ramp(self, settings: _Settings) -> Ramp:
        mode = settings.choice("rampType", _RAMP_MODES, "distanceToLight")
        begin, end = settings.number("beginDist", 0.0), settings.number("endDist", 10.0)
        scale = float(np.linalg.norm(self._world[:3, 0])) if mode == "distanceToLight" else 1.0
        at = np.linspace(0.0, 1.0, RAMP_STEPS)
        falloff, color = settings.spline("falloff", "Floats", at), settings.spline("colorRamp", "Colors", at)
        if falloff is None and color is None:
            raise ValueError("it has neither falloff_Floats nor colorRamp_Colors")
        colors = np.ones((RAMP_STEPS, 3)) * (1.0 if falloff is None else falloff) * (1.0 if color is None else color)
        return Ramp(_RAMP_MODES[mode], begin * scale, end * scale, colors.astype(np.float32))

    def _note_unread(self, prim: Usd.Prim, settings: _Settings) -> None:
        """Note parameters that are authored and count for nothing, and a filter that is not for all surfaces."""
        path = prim.GetPath()
        if settings.unread():
            named = ", ".join(settings.unread())
            self._log.add("filter_setting", path, f"light filter {path} is drawn without its {named}")
        root, expression = (
            prim.GetAttribute(f"collection:filterLink:{name}") for name in ("includeRoot", "membershipExpression")
        )
        excludes = prim.GetRelationship("collection:filterLink:excludes")
        names_some = expression and expression.HasAuthoredValue() and expression.Get() != Sdf.PathExpression()
        if (root and root.Get() is False) or (excludes and excludes.GetForwardedTargets()) or names_some:
            self._log.add("filter_link", path, f"light filter {path} acts on all surfaces: filterLink is not honoured")


def saturate(rgb: tuple[float, float, float], saturation: float) -> tuple[float, float, float]:
    """A colour of the working space with its distance from the grey of its luminance multiplied, in linear Rec. 709."""
    if saturation == 1:
        return rgb
    to_working = np.array([colour.rgb_to_working(primary) for primary in _PRIMARIES]).T
    linear = np.linalg.solve(to_working, rgb)
    grey = float(_LUMINANCE @ linear)
    red, green, blue = (float(channel) for channel in to_working @ np.maximum(grey + (linear - grey) * saturation, 0.0))
    return red, green, blue


class _Settings:
    """Parameters of a filter prim at a time, under any of their names."""

    def __init__(self, prim: Usd.Prim, time: Usd.TimeCode) -> None:
        self.prim = prim
        self._time = time
        self._read: set[str] = set()

    def value(self, name: str) -> object:
        """Value of a parameter, or None."""
        for spelling in (f"inputs:{name}", f"inputs:ri:{name}", name, *_SPELLINGS.get(name, ())):
            self._read.add(spelling)
            attribute = self.prim.GetAttribute(spelling)
            value = attribute.Get(self._time) if attribute and attribute.HasAuthoredValue() else None
            if value is not None:
                return value
        return None

    def number(self, name: str, otherwise: float) -> float:
        """A number within single precision.

        Raises:
            ValueError: it is none.
        """
        value = self.value(name)
        if value is None:
            return otherwise
        if not isinstance(value, int | float) or not abs(value) <= _MOST:
            raise ValueError(f"its {name} must be a number up to {_MOST:g}, got {value!r:.40}")
        return float(value)

    def choice(self, name: str, names: Sequence[str] | Mapping[str, object], otherwise: str) -> str:
        """One of some names, which may be given by its number.

        Raises:
            ValueError: it is none.
        """
        value, known = self.value(name), list(names)
        if value is None:
            return otherwise
        if isinstance(value, int) and 0 <= value < len(known):
            return known[value]
        if str(value) not in known:
            raise ValueError(f"its {name} must be one of {', '.join(known)}, got {value!r:.40}")
        return str(value)

    def spline(self, name: str, values: str, at: DoubleArray) -> DoubleArray | None:
        """Values ``(n, 1)`` or ``(n, 3)`` of a spline at places from 0 to 1; None where it is not authored.

        Raises:
            ValueError: it is no linear or constant spline.
        """
        knots, heights = self.value(f"{name}_Knots"), self.value(f"{name}_{values}")
        kind = str(self.value(f"{name}_Interpolation") or "linear")
        self.value(name)  # the count of knots, which the lists have too
        if heights is None:
            return None
        places, found = np.array(knots, np.float64).reshape(-1), np.array(heights, np.float64)
        found = found.reshape(len(found), -1) if len(found) else np.zeros((0, 1))
        is_right = 0 < len(places) == len(found) and np.isfinite(places).all() and (np.abs(found) <= _MOST).all()
        if not is_right or (np.diff(places) < 0).any():
            raise ValueError(f"its {name} must have as many rising knots as values")
        if kind == "constant":
            return np.asarray(found[np.clip(np.searchsorted(places, at, side="right") - 1, 0, None)])
        if kind != "linear":
            raise ValueError(f"its {name} is a spline of kind {kind}: linear and constant are supported")
        return np.stack([np.interp(at, places, found[:, i]) for i in range(found.shape[1])], axis=1)

    def unread(self) -> list[str]:
        """Authored parameters that nothing has asked for and that differ from what has no effect."""
        known = (
            "visibility",
            "purpose",
            "xformOp",
            "collection:",
            "lightFilter:",
            "ri:lightFilter:",
            "ui:",
            "primvars:",
        )
        authored = (attribute for attribute in self.prim.GetAuthoredAttributes() if attribute.HasAuthoredValue())
        names = [attribute.GetName() for attribute in authored]
        return sorted(name for name in names if name not in self._read and not name.startswith(known))


def _is_invisible(prim: Usd.Prim, time: Usd.TimeCode) -> bool:
    """Whether a filter is off, by its own visibility where USD does not know its type."""
    imageable = UsdGeom.Imageable(prim)
    if imageable:
        return bool(imageable.ComputeVisibility(time) == UsdGeom.Tokens.invisible)
    visibility = prim.GetAttribute("visibility")
    return bool(visibility and visibility.Get(time) == UsdGeom.Tokens.invisible)


def _kind(prim: Usd.Prim, settings: _Settings) -> str:
    """RenderMan's name of a filter: of its type, or of the shader that a filter without a kind names."""
    kind = str(prim.GetTypeName())
    if kind in ("LightFilter", "PluginLightFilter"):
        return str(settings.value("ri:lightFilter:shaderId") or settings.value("lightFilter:shaderId") or kind)
    return kind or schema_type(prim)


def _effect(settings: _Settings) -> float:
    return settings.number("intensity", 1.0) * float(2.0 ** min(max(settings.number("exposure", 0.0), -60.0), 30.0))


def _density(settings: _Settings) -> float:
    return min(max(settings.number("density", 1.0), 0.0), 1.0)


def _multipliers(settings: _Settings) -> tuple[float, float]:
    """Multipliers of a light's diffuse response and of its highlights."""
    effect = _effect(settings)
    if settings.number("invert", 0.0):
        effect = 1 / effect if effect > 0 else 0.0
    effect = 1 + _density(settings) * (effect - 1)
    diffuse, specular = settings.number("diffuse", 1.0), settings.number("specular", 1.0)
    multipliers = 1 + (effect - 1) * diffuse, 1 + (effect - 1) * specular
    _check_strength(*multipliers)
    return multipliers


def _peak(one: LightFilter) -> float:
    """Multiplier of light by a filter at any place: the greatest, without its sign.

    Raises:
        ValueError: it is too great.
    """
    share = np.array((one.shape.colors.min(), one.shape.colors.max()) if isinstance(one.shape, Ramp) else (0.0, 1.0))
    share = 1 - share if one.inverted else share
    effect = (1 + (share - 1) * one.density) * one.strength
    peak = max(float(np.abs(1 + (effect - 1) * response).max()) for response in (one.diffuse, one.specular))
    _check_strength(peak)
    return peak


def _check_strength(*multipliers: float) -> None:
    if not all(abs(multiplier) <= _MOST for multiplier in multipliers):
        raise ValueError(f"it multiplies light by more than {_MOST:g}")


def _filter(settings: _Settings, shape: Barn | Ramp, pose: DoubleArray) -> LightFilter:
    return LightFilter(
        shape,
        pose,
        density=_density(settings),
        strength=_effect(settings),
        inverted=bool(settings.number("invert", 0.0)),
        diffuse=settings.number("diffuse", 1.0),
        specular=settings.number("specular", 1.0),
    )


def _barn(settings: _Settings, light: DoubleArray) -> Barn:
    """Barn doors. Width, height and radius are diameters, and the corners' circles lie outside of width and height; the scales
    act on all of the shape.

    Args:
        settings: of the filter.
        light: place ``(4,)`` of the light in the filter's units, or the direction towards it.
    """
    radius, edge = settings.number("radius", 0.5), settings.number("edge", 0.0)
    spans = dict.fromkeys(_SIDES[:2], settings.number("width", 1.0)) | dict.fromkeys(
        _SIDES[2:], settings.number("height", 1.0)
    )
    half = [settings.number("scaleWidth", 1.0) / 2] * 2 + [settings.number("scaleHeight", 1.0) / 2] * 2
    sides = [
        scale * (spans[side] + settings.number(side, 0.0) + radius) for side, scale in zip(_SIDES, half, strict=True)
    ]
    edges = [scale * edge * settings.number(f"{side}Edge", 1.0) for side, scale in zip(_SIDES, half, strict=True)]
    left, right, bottom, top = sides
    window = Window((left, right, bottom, top), (abs(radius * half[0]), abs(radius * half[2])), _positive(edges))
    if left + right <= 0 or bottom + top <= 0:
        raise ValueError("its opening has no width or no height")
    before = _PRE_BARN[settings.choice("preBarn", _PRE_BARN, "noEffect")]
    if settings.choice("barnMode", _BARN_MODES, "physical") == "physical":
        for name in ("apex", "directional", "useLightDirection", "shearX", "shearY", "edge"):
            settings.value(name)  # counts in the other mode alone
        return Barn(window, before)
    if settings.number("shearX", 0.0) or settings.number("shearY", 0.0):
        raise ValueError("sheared barn doors are not supported")
    towards = np.array([0.0, 0.0, 1.0])
    if settings.number("useLightDirection", 0.0):
        towards = light[:3] / max(float(np.linalg.norm(light[:3])), 1e-12)
    apex = settings.number("apex", _APEX)
    if towards[2] <= 0 or apex <= 0:
        raise ValueError("its light comes from behind its doors")
    is_parallel = bool(settings.number("directional", 0.0))
    x, y, z = (float(number) for number in (towards if is_parallel else towards * apex))
    return Barn(window, before, (x, y, z, 0.0 if is_parallel else 1.0))


def _positive(numbers: Sequence[float]) -> tuple[float, float, float, float]:
    left, right, bottom, top = (max(number, 0.0) for number in numbers)
    return left, right, bottom, top
