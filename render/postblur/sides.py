"""Near and far field of a picture: its parts before and behind the focus, which every single-image engine blurs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import moderngl

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.peel import Layers
from render.model.lens import IrisShape
from render.trace.axis_rays import LensErrors
from render.trace.focal_map import FocalMaps
from render.trace.picture_focus import PictureFocus


@dataclass(frozen=True)
class Sides:
    """A picture in two, parted at the focus. Its textures are valid until they are given back.

    Attributes:
        near: RGBA32F premultiplied: what is in front of the focus.
        far: RGBA32F premultiplied: what is in focus or behind it, the background too; also behind what is near, where the
            peeled layers know it. Opaque, or empty where something near hides all that they know.
        radii: RG32F: radii of the circles of confusion of near and of far, in pixels.
        most_px: no radius is larger.
        iris: whose image a point out of focus is spread over.
        squeeze: of an anamorphic lens, whose blurs are narrower by it.
        errors: of the lens, for a blur that draws them; None where it has none.
    """

    near: moderngl.Texture
    far: moderngl.Texture
    radii: moderngl.Texture
    most_px: float
    iris: IrisShape
    squeeze: float = 1.0
    errors: LensErrors | None = None

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        size: tuple[int, int] = self.near.size
        return size


class Blur(Protocol):
    """A single-image engine: spreads each point of a picture over its circle of confusion."""

    def blurred(self, sides: Sides, held: Resources) -> moderngl.Texture:
        """The picture, RGBA32F premultiplied and as large as the sides, kept by ``held``."""
        ...

    def release(self) -> None:
        """Give back what is kept between pictures."""
        ...


class Collector:
    """Parts peeled layers at the focus: the circle-of-confusion pass."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._maps = FocalMaps(ctx, programs)

    def sides(
        self,
        peeled: Layers,
        focus: PictureFocus,
        pupil_px: float,
        most_px: float,
        iris: IrisShape,
        squeeze: float,
        held: Resources,
    ) -> Sides:
        """Part a peeled scene.

        Args:
            peeled: its layers.
            focus: where each of their pixels is focused; its view is theirs.
            pupil_px: the pupil's radius times the focal length, px·m of the focus's view.
            most_px: larger radii are taken for as large.
            iris: of the lens.
            squeeze: likewise.
            held: keeps what is made.
        """
        view, affine, targets = focus.view, focus.affine, peeled.targets
        near, far = (held.keep(self._ctx.texture((view.width, view.height), 4, dtype="f4")) for _ in range(2))
        radii = held.keep(self._ctx.texture((view.width, view.height), 2, dtype="f4"))
        program = self._programs.compute("postblur/sides.comp")
        sources: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w[0],
            "packed_w_far": targets.packed_w[-1],
            "radiance": targets.radiance,
            "background": targets.background,
            "focal_map": self._maps.made(focus) if affine is None else radii,
        }
        for unit, (name, texture) in enumerate(sources.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        set_uniforms(program, is_mapped=affine is None, focus=affine or (0.0, 0.0, 0.0), pupil_px=pupil_px)
        set_uniforms(program, most_px=most_px, layers=peeled.count)
        for unit, texture in enumerate((near, far, radii)):
            texture.bind_to_image(unit, read=False, write=True)
        program.run(-(-view.width // 8), -(-view.height // 8))
        self._ctx.memory_barrier()
        return Sides(near, far, radii, most_px, iris, squeeze)

    def release(self) -> None:
        """Give the memory back."""
        self._maps.release()
