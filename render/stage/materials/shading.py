"""Reading UsdShade networks: what feeds an input, whatever interfaces and node graphs lie between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from pxr import Sdf, Usd, UsdShade

from render.stage.color_spaces import SpaceName, space_of
from render.stage.geometry.primvars import as_rows


@dataclass(frozen=True, eq=False)
class Source:
    """Source of a shader input's value.

    Attributes:
        value: the constant, or None where a shader feeds it.
        shader: the shader, or None where it is a constant.
        output: name of the shader's output, such as ``rgb``.
        attribute: where a constant is authored.
    """

    value: object = None
    shader: UsdShade.Shader | None = None
    output: str = ""
    attribute: Usd.Attribute | None = None


class NetworkReader:
    """Reads inputs at a time and notices whether any of them may change over time.

    Args:
        time: when.
    """

    def __init__(self, time: Usd.TimeCode) -> None:
        self._time = time
        self.varies = False

    def source(self, shader: UsdShade.Shader, name: str) -> Source | None:
        """Source of an input's value, or None where nothing is authored."""
        shader_input = shader.GetInput(name)
        if not shader_input:
            return None
        for attribute in shader_input.GetValueProducingAttributes():
            output = UsdShade.Output(attribute)
            if UsdShade.Output.IsOutput(attribute):
                return Source(shader=UsdShade.Shader(attribute.GetPrim()), output=output.GetBaseName())
            if attribute.HasAuthoredValue():
                self.varies = self.varies or attribute.ValueMightBeTimeVarying()
                return Source(value=attribute.Get(self._time), attribute=attribute)
        return None

    def constant(self, shader: UsdShade.Shader, name: str, default: object) -> object:
        """An input's constant value, or the default where it has none."""
        found = self.source(shader, name)
        return default if found is None or found.value is None else found.value

    def numbers(self, shader: UsdShade.Shader, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """A constant input's components, or the default where it has none or another number of them."""
        return as_numbers(self.constant(shader, name, None), default)

    def rgba(self, shader: UsdShade.Shader, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
        """Four numbers of a constant input; one of three numbers has the default's alpha."""
        rgb = self.numbers(shader, name, default[:3])
        return self.numbers(shader, name, (*rgb, default[3]))

    def asset(self, shader: UsdShade.Shader, name: str) -> Sdf.AssetPath | None:
        """An asset input, or None."""
        value = self.constant(shader, name, None)
        return value if isinstance(value, Sdf.AssetPath) else None

    def color_space(self, shader: UsdShade.Shader, name: str) -> SpaceName:
        """The colour space that is authored on an input as metadata, or an empty string."""
        shader_input = shader.GetInput(name)
        for attribute in shader_input.GetValueProducingAttributes() if shader_input else []:
            if attribute.HasColorSpace():
                return space_of(attribute)
        return ""


def as_numbers(value: object, default: tuple[float, ...]) -> tuple[float, ...]:
    """The components of a USD number or vector, or the default where `finite_numbers` has none."""
    return finite_numbers(value, len(default)) or default


def finite_numbers(value: object, width: int) -> tuple[float, ...] | None:
    """The components of a USD number or vector, or None where the width differs or a component is not finite."""
    rows = as_rows(value, width)
    if rows is None or len(rows) != 1 or not np.isfinite(rows).all():
        return None
    return tuple(float(v) for v in rows[0])
