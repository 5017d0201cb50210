"""A dome's image as rough mirrors see it, for the highlights of domes: one level for each of some roughnesses.

Karis 2013, "Real shading in Unreal Engine 4", SIGGRAPH course notes.
"""

from __future__ import annotations

import moderngl

from render.gl.shaders import ProgramCache, set_uniforms

GLOSS_UNIT = 15
"""Texture unit as ``layers/lighting.glsl`` binds it."""
GLOSS_LEVELS = 6
_WIDTH = 512
_GROUP = 8
_SAMPLES = (
    32,
    32,
    128,
    128,
    128,
    128,
)  # of each texel of each level; narrow lobes need few, since each stands for a small cone


class DomeGloss:
    """Levels whose lobes are twice as wide each, up to roughness 1; of 512x256 texels, and of half as many across and down each.
    Filling them takes 0.2 s of processor time with Mesa's software rasteriser, whatever the size of the image.

    Args:
        ctx: context.
        programs: its programs.
    """

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._levels: moderngl.Texture | None = None

    def fill(self) -> None:
        """Fill the levels from the image that is bound as ``dome_map``."""
        self.release()
        levels = self._ctx.texture((_WIDTH, _WIDTH // 2), 4, dtype="f2")
        self._levels = levels
        levels.build_mipmaps(max_level=GLOSS_LEVELS - 1)
        levels.filter = moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR
        levels.repeat_x, levels.repeat_y = True, False
        program = self._programs.compute("layers/dome_glossy.comp")
        for number in range(GLOSS_LEVELS):
            set_uniforms(program, roughness=2 ** ((number + 1 - GLOSS_LEVELS) / 2), samples=_SAMPLES[number])
            levels.bind_to_image(0, read=False, write=True, level=number)
            program.run(-(-(_WIDTH >> number) // _GROUP), -(-(_WIDTH >> number + 1) // _GROUP))
            self._ctx.memory_barrier()

    def bind(self) -> None:
        """Bind the levels to their texture unit, where there are any."""
        if self._levels is not None:
            self._levels.use(GLOSS_UNIT)

    def release(self) -> None:
        """Release the memory on the device."""
        if self._levels is not None:
            self._levels.release()
        self._levels = None
