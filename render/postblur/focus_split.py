"""Split of a picture at the focus into a near and a far field, which every single-image engine blurs apart."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import moderngl

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.layers.peeled import Layers
from render.model.lens import IrisShape
from render.trace.axis_rays import LensErrors
from render.trace.focal_map import FocalMaps
from render.trace.picture_focus import PictureFocus

if TYPE_CHECKING:  # loaded where a scene has splats
    from render.trace.splats.planes import SplatPlanes

SPLIT_PX = 24.0
"""Radius in pixels up to which circles of confusion are drawn at full resolution, where a blur draws larger ones at less."""


@dataclass(frozen=True)
class FocusSplit:
    """A picture split at the focus. Its textures are valid until they are released.

    Attributes:
        near: RGBA32F premultiplied: the surfaces in front of the focus.
        far: RGBA32F premultiplied: the surfaces in focus or behind it, and the background; also behind the near field, where the
            peeled layers know it. Opaque, or empty where near surfaces hide all that the layers know.
        radii: RG32F: radii of the circles of confusion of the near and the far field, in pixels.
        most_px: upper bound on the radii.
        iris: iris whose image a point out of focus is spread over.
        squeeze: anamorphic squeeze, by which blurs are narrower.
        errors: errors of the lens, for a blur that draws them; None for no errors.
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

    def blur(self, split: FocusSplit, scope: Resources) -> moderngl.Texture:
        """Blur a picture.

        Args:
            split: near and far field of the picture.
            scope: scope that owns the result.

        Returns:
            RGBA32F premultiplied, as large as the fields.
        """
        ...

    def release(self) -> None:
        """Release what is kept between pictures."""
        ...


class FocusSplitter:
    """Splits peeled layers at the focus: the circle-of-confusion pass of Moersch & Hamilton 2014, section 3.2.1."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._maps = FocalMaps(ctx, programs)

    def split(
        self,
        peeled: Layers,
        focus: PictureFocus,
        pupil_px: float,
        most_px: float,
        iris: IrisShape,
        squeeze: float,
        scope: Resources,
        splats: SplatPlanes | None = None,
    ) -> FocusSplit:
        """Split a peeled scene at the focus.

        Args:
            peeled: its layers.
            focus: focus of each of the layers' pixels; its view is the layers'.
            pupil_px: the pupil's radius times the focal length, px·m of the focus's view.
            most_px: bound to which radii are clamped.
            iris: iris of the lens.
            squeeze: anamorphic squeeze of the lens.
            scope: scope that owns the textures.
            splats: planes of splats between the layers. A field that has some is blurred by the mean of its radii.
        """
        view, affine, targets = focus.view, focus.affine, peeled.targets
        near, far = (scope.keep(self._ctx.texture((view.width, view.height), 4, dtype="f4")) for _ in range(2))
        radii = scope.keep(self._ctx.texture((view.width, view.height), 2, dtype="f4"))
        program = self._programs.compute("postblur/focus_split.comp", {} if splats is None else {"SPLATS": 1})
        sources: dict[str, moderngl.Texture | moderngl.TextureArray] = {
            "packed_w": targets.packed_w[0],
            "packed_w_far": targets.packed_w[-1],
            "radiance": targets.radiance,
            "background": targets.background,
            "focal_map": self._maps.draw(focus) if affine is None else targets.background,  # not read where affine
        }
        for unit, (name, texture) in enumerate(sources.items()):
            texture.use(unit)
            set_uniforms(program, **{name: unit})
        if splats is not None:
            splats.bind(program, len(sources))
        set_uniforms(program, is_mapped=affine is None, focus=affine or (0.0, 0.0, 0.0), pupil_px=pupil_px)
        set_uniforms(program, most_px=most_px, layers=peeled.count)
        for unit, texture in enumerate((near, far, radii)):
            texture.bind_to_image(unit, read=False, write=True)
        program.run(-(-view.width // 8), -(-view.height // 8))
        self._ctx.memory_barrier()
        return FocusSplit(near, far, radii, most_px, iris, squeeze)

    def release(self) -> None:
        """Release the memory."""
        self._maps.release()
