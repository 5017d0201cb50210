"""Colour spaces of authored colours, by metadata of attributes and by USD's colour space schemas, to linear Rec. 709.

An attribute's own ``colorSpace`` counts first, then the nearest ``ColorSpaceAPI`` at its prim or above; without either, colours
are linear Rec. 709. A name is one of USD's, one that a ``ColorSpaceDefinitionAPI`` at the prim or above it defines, or one of
OpenColorIO's configuration.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from pxr import Gf, Usd

from render import colour
from render.errors import InputError
from render.model.arrays import DoubleArray, FloatArray
from render.stage.findings import FindingLog

_REC709 = Gf.ColorSpace(Gf.ColorSpaceNames.LinearRec709)
_AS_THEY_ARE = ("", "raw", "data", "unknown", "identity", colour.USD_LINEAR, str(Gf.ColorSpaceNames.LinearRec709))
_D65 = np.array([0.3127, 0.329])
_CONES = np.array([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]])
_LEAST_AREA = 1e-6
_Matrix = tuple[tuple[float, ...], ...]


@dataclass(frozen=True)
class RgbSpace:
    """Colour space by its primaries and its transfer function, as Gf.ColorSpace has them.

    Attributes:
        name: for messages.
        to_rec709: ``(3, 3)`` linear Rec. 709 from its linear values.
        gamma: exponent.
        linear_bias: ``a`` of ``((v + a) / (1 + a)) ** gamma``.
        linear_end: encoded value up to which the function is a line.
        linear_slope: encoded value over linear value on the line.
    """

    name: str
    to_rec709: _Matrix
    gamma: float = 1.0
    linear_bias: float = 0.0
    linear_end: float = 0.0
    linear_slope: float = 1.0

    @classmethod
    def of(cls, space: Gf.ColorSpace) -> RgbSpace:
        """Take over a colour space."""
        gamma, bias = float(space.GetGamma()), float(space.GetLinearBias())
        end, slope = (float(v) for v in space.GetTransferFunctionParams()) if bias > 0 else (0.0, 1.0)
        line = Gf.ColorSpace("its linear values", space.GetRGBToXYZ(), 1.0, 0.0)
        columns = [_REC709.Convert(line, Gf.Vec3f(*axis)).GetRGB() for axis in np.eye(3).tolist()]
        matrix = tuple(tuple(float(column[row]) for column in columns) for row in range(3))
        return cls(str(space.GetName()), matrix, gamma, bias, end, slope)

    def linearise(self, pixels: FloatArray) -> FloatArray:
        """Linear Rec. 709 values ``(..., 3)`` or ``(..., 4)`` of encoded ones; alpha passes through."""
        out = np.array(pixels, np.float32)
        rgb = out[..., :3]
        if self.gamma != 1:
            bent = np.maximum((rgb + self.linear_bias) / (1 + self.linear_bias), 0) ** self.gamma
            rgb = np.where(rgb <= self.linear_end, rgb / self.linear_slope if self.linear_end > 0 else 0, bent)
        out[..., :3] = rgb @ np.array(self.to_rec709, np.float32).T
        return out


SpaceName = str | RgbSpace
"""Colour space by a name that OpenColorIO knows, or by its own numbers."""


def from_chromaticities(name: str, numbers: Sequence[float]) -> RgbSpace | None:
    """Linear colour space of eight chromaticities: x and y of red, green, blue and white; None where there is none such.

    White is adapted to that of Rec. 709 (Bradford; ICC.1:2022, annex E).
    """
    points = np.array(numbers, np.float64).reshape(4, 2)
    if not np.isfinite(points).all() or (points[3] <= 0).any() or points[3].sum() > 1:
        return None
    primaries = np.concatenate([points[:3], 1 - points[:3].sum(axis=1, keepdims=True)], axis=1).T
    if abs(np.linalg.det(primaries)) < _LEAST_AREA:
        return None
    white = _xyz_of(points[3])
    to_xyz = primaries * np.linalg.solve(primaries, white)
    gains = np.diag((_CONES @ _xyz_of(_D65)) / (_CONES @ white))
    adapted = np.linalg.inv(_CONES) @ gains @ _CONES @ to_xyz
    matrix = np.linalg.inv(np.array(_REC709.GetRGBToXYZ(), np.float64).reshape(3, 3)) @ adapted
    return RgbSpace(name, tuple(map(tuple, matrix.tolist())))


def _xyz_of(point: DoubleArray) -> DoubleArray:
    """XYZ of a chromaticity, Y = 1."""
    x, y = point
    return np.array([x / y, 1.0, (1 - x - y) / y])


def linearise(pixels: FloatArray, space: SpaceName) -> FloatArray:
    """Linear Rec. 709 values of encoded ones, ``(..., 3)`` or ``(..., 4)``.

    Raises:
        InputError: the name is not known.
    """
    return space.linearise(pixels) if isinstance(space, RgbSpace) else colour.linearise(pixels, space)


def space_of(attribute: Usd.Attribute) -> SpaceName:
    """Colour space of an attribute's colours; empty where nothing is authored about it."""
    name = str(Usd.ColorSpaceAPI.ComputeColorSpaceName(attribute, None) or "")
    if name in _AS_THEY_ARE or Gf.ColorSpace.IsValid(name):
        return name
    defined = Usd.ColorSpaceAPI.ComputeColorSpace(attribute, None)
    return RgbSpace.of(defined) if defined.GetName() else name


def to_rec709(values: FloatArray, attribute: Usd.Attribute, log: FindingLog) -> FloatArray:
    """Linear Rec. 709 values of an attribute's colours.

    Args:
        values: ``(..., 3)`` float32 as authored.
        attribute: whose.
        log: receives colour spaces that are not known; the values then count as linear Rec. 709.
    """
    space = space_of(attribute)
    if space in _AS_THEY_ARE:
        return values
    try:
        return linearise(values, space)
    except InputError as problem:
        path = attribute.GetPath()
        log.add("unknown_color_space", path, f"colours of {path} count as linear Rec. 709: {problem}")
        return values


def rgb_to_working(
    rgb: Sequence[float], attribute: Usd.Attribute | None, log: FindingLog
) -> tuple[float, float, float]:
    """One colour in the working space, by the colour space of its attribute, if it has one."""
    values = np.array(rgb, np.float32)
    red, green, blue = (float(v) for v in (values if attribute is None else to_rec709(values, attribute, log)))
    return colour.rgb_to_working((red, green, blue))
