"""Opacity of surfaces by MaterialX, as far as their constants tell it."""

from __future__ import annotations

from render.stage.materials.mtlx.network import Input, Node
from render.stage.materials.mtlx.surfaces import SURFACES
from render.stage.materials.mtlx.values import numbers_of


def is_used(given: Input | None, default: float = 0.0) -> bool:
    """Whether an input is connected, or has another value than its default."""
    if given is None:
        return False
    return given.source is not None or any(number != default for number in numbers_of(given))


def may_be_transparent(surface: Node) -> bool:
    """Whether a surface that is drawn, and is no mix, may be wholly or partly transparent somewhere."""
    shader = SURFACES[surface.category]
    inputs = zip(shader.opacity, shader.opaque, strict=True)
    return any(is_used(surface.inputs.get(name), opaque) for name, opaque in inputs)


def opacity_of(surface: Node) -> float:
    """Share of what is behind that a surface hides, as its shader has it for constants; what is connected counts as opaque.

    Args:
        surface: one that is drawn, and is no mix.
    """
    shader, opacity = SURFACES[surface.category], 1.0
    for name, opaque in zip(shader.opacity, shader.opaque, strict=True):
        value = _constant(surface, name, opaque)
        if opaque:
            opacity *= _cut(surface, 1.0 if value is None else value)
        elif value is not None:
            metal, tint = _constant(surface, shader.metal, 0.0), _constant(surface, shader.tint, 1.0)
            if metal is not None and tint is not None:
                opacity *= 1 - 0.96 * value * (1 - metal) * tint
    return opacity


def _cut(surface: Node, opacity: float) -> float:
    """Opacity by the surface's mode and threshold."""
    if surface.category == "gltf_pbr":
        mode, least = _constant(surface, "alpha_mode", 0.0), _constant(surface, "alpha_cutoff", 0.5)
        return opacity if mode not in (0, 1) else float(mode == 0 or opacity >= (least or 0.0))
    least = _constant(surface, "opacityThreshold", 0.0)
    return float(opacity >= least) if least else opacity


def _constant(surface: Node, name: str | None, default: float) -> float | None:
    """Mean of the numbers of a constant input; the default where there is none, and None where it is connected."""
    given = surface.inputs.get(name) if name is not None else None
    if given is not None and given.source is not None:
        return None
    numbers = numbers_of(given)
    return min(max(sum(numbers) / len(numbers), 0.0), 2.0) if numbers else default
