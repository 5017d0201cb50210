"""Both sides of a picture blurred, and joined: what engines share that spread each side by itself.

What is behind the focus is parted once more: what is little blurred hides what lies behind it, whose wider blur must not reach
over it.
"""

from __future__ import annotations

from dataclasses import dataclass

import moderngl

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.postblur.blur_shape import BlurShape, blur_shape
from render.postblur.shed import Field, Window
from render.postblur.sides import Sides

LITTLE_SHARE, LITTLE_PX = 0.2, (1.5, 6.0)
"""Bound between slightly and strongly blurred: this share of the picture's largest radius, clamped to these pixels."""
_HAZE = 1.5  # up to so many times that, what is blurred hides the less the more it is blurred


@dataclass(frozen=True)
class Part:
    """Some of a picture, to be blurred by itself.

    Attributes:
        name: as the shader that joins them has it.
        field: of the picture.
        shape: of its blur.
        window: what of the field it is.
        most_px: no radius in the window is larger.
    """

    name: str
    field: Field
    shape: BlurShape
    window: Window
    most_px: float


def parts_of(sides: Sides) -> tuple[Part, Part, Part]:
    """Split the picture into three parts: the near field, the slightly blurred far field, and the strongly blurred far field."""
    before = blur_shape(sides.iris, behind=False, squeeze=sides.squeeze)
    behind = blur_shape(sides.iris, behind=True, squeeze=sides.squeeze)
    near, far = Field(sides.near, sides.radii, 0), Field(sides.far, sides.radii, 1)
    little = min(max(LITTLE_SHARE * sides.most_px, LITTLE_PX[0]), LITTLE_PX[1])
    hazy = _HAZE * little
    return (
        Part("near", near, before, Window(), sides.most_px),
        Part("middle", far, behind, Window(fall=(little, hazy)), min(hazy, sides.most_px)),
        Part("far", far, behind, Window(rise=(little, little * (1 + 1e-3))), sides.most_px),
    )


@dataclass(frozen=True)
class Blurred:
    """A part when it is blurred.

    Attributes:
        fine: RGBA32F: its light and how much there is of it.
        wide: what of it is blurred at less resolution, or None.
        shrink: pixels of the picture to one of those, along each axis.
    """

    fine: moderngl.Texture
    wide: moderngl.Texture | None = None
    shrink: int = 1


class Joiner:
    """Joins the parts of pictures, with the programs of one context."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs

    def joined(self, sides: Sides, blurred: dict[str, Blurred], held: Resources) -> moderngl.Texture:
        """The picture.

        Args:
            sides: that it was.
            blurred: its parts by their names; without a middle one where the far side is one.
            held: keeps the picture.
        """
        program = self._programs.compute("postblur/postblur_join.comp", {"MIDDLE": 1} if "middle" in blurred else {})
        textures = {"far_sharp": sides.far, "radii": sides.radii}
        for name, part in blurred.items():
            textures |= {name: part.fine, f"{name}_wide": part.wide or part.fine}
            wide_px = tuple(part.shrink * side for side in (part.wide or part.fine).size)
            set_uniforms(program, **{f"{name}_wide_px": wide_px if part.wide else (0.0, 0.0)})
        for unit, (name, texture) in enumerate(textures.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        picture: moderngl.Texture = held.keep(self._ctx.texture(sides.size, 4, dtype="f4"))
        picture.bind_to_image(0, read=False, write=True)
        program.run(-(-picture.width // 8), -(-picture.height // 8))
        self._ctx.memory_barrier()
        return picture
