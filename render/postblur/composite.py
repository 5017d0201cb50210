"""Compositing of blurred parts, shared by the engines that blur the near and the far field apart.

The far field is split once more: its slightly blurred part hides what lies behind it, whose wider blur must not reach
over it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import moderngl

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape, make_blur_shape
from render.postblur.focus_split import FocusSplit
from render.postblur.point_spread import ALL_RADII, Field, RadiusWindow

LITTLE_SHARE, LITTLE_PX = 0.2, (1.5, 6.0)
"""Bound between slightly and strongly blurred: this share of the picture's largest radius, clamped to these pixels."""
_HAZE = 1.5  # up to this factor times the bound, the slightly blurred part fades out


@dataclass(frozen=True)
class Part:
    """A part of a picture that is blurred by itself.

    Attributes:
        name: name of the part in ``postblur/composite.comp``.
        field: field that it belongs to.
        shape: shape of its blur.
        window: range of radii of the field that it holds.
        most_px: upper bound on the radii in the window.
    """

    name: str
    field: Field
    shape: BlurShape
    window: RadiusWindow
    most_px: float


def split_into_parts(split: FocusSplit) -> tuple[Part, Part, Part]:
    """Split the picture into three parts: the near field, the slightly blurred far field, and the strongly blurred far field."""
    before = make_blur_shape(split.iris, behind=False, squeeze=split.squeeze)
    behind = make_blur_shape(split.iris, behind=True, squeeze=split.squeeze)
    near, far = Field(split.near, split.radii, 0), Field(split.far, split.radii, 1)
    little = min(max(LITTLE_SHARE * split.most_px, LITTLE_PX[0]), LITTLE_PX[1])
    hazy = _HAZE * little
    return (
        Part("near", near, before, ALL_RADII, split.most_px),
        Part("middle", far, behind, RadiusWindow(fall=(little, hazy)), min(hazy, split.most_px)),
        Part("far", far, behind, RadiusWindow(rise=(little, little * (1 + 1e-3))), split.most_px),
    )


@dataclass(frozen=True)
class BlurredPart:
    """A part after its blur.

    Attributes:
        fine: RGBA32F: light and coverage, at full resolution.
        wide: the same of its wide blurs at less resolution, or None.
        shrink: pixels of the picture per pixel of ``wide``, along each axis.
    """

    fine: moderngl.Texture
    wide: moderngl.Texture | None = None
    shrink: int = 1


class Compositor:
    """Composites the blurred parts of pictures, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def composite(self, split: FocusSplit, blurred: dict[str, BlurredPart], scope: Resources) -> moderngl.Texture:
        """Composite the parts from the front to the back.

        Args:
            split: the picture before its blur.
            blurred: blurred parts by name; no ``middle`` where the far field is one part.
            scope: scope that owns the result.

        Returns:
            RGBA32F: radiance premultiplied by coverage, and coverage.
        """
        program = self._programs.compute("postblur/composite.comp", {"MIDDLE": 1} if "middle" in blurred else {})
        textures = {"far_sharp": split.far, "radii": split.radii}
        for name, part in blurred.items():
            textures |= {name: part.fine, f"{name}_wide": part.wide or part.fine}
            wide_px = tuple(part.shrink * side for side in (part.wide or part.fine).size)
            set_uniforms(program, **{f"{name}_wide_px": wide_px if part.wide else (0.0, 0.0)})
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        picture: moderngl.Texture = scope.keep(self._ctx.texture(split.size, 4, dtype="f4"))
        picture.bind_to_image(0, read=False, write=True)
        program.run(-(-picture.width // 8), -(-picture.height // 8))
        self._ctx.memory_barrier()
        return picture

    def blur_parts(
        self, split: FocusSplit, blur_part: Callable[[Part, Resources], BlurredPart], scope: Resources
    ) -> moderngl.Texture:
        """Blur the parts of a picture and draw them over each other.

        Args:
            split: the picture.
            blur_part: blurs a part; the scope that it is given owns the result.
            scope: owns the textures.

        Returns:
            The picture, RGBA32F, premultiplied.
        """
        parts = {part.name: blur_part(part, scope) for part in split_into_parts(split)}
        return self.composite(split, parts, scope)
