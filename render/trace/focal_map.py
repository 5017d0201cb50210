"""Focal surface of each pixel, on the device: ``trace/focal_surface.comp``."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.area import Area
from render.model.arrays import FloatArray
from render.model.focal_surface import MAX_HALVES, Controls
from render.trace.picture_focus import PictureFocus

_POINTS, _BENDS, _STRETCH, _IMAGE = 0, 1, 2, 1  # as the shader binds them
_CHIEF_RAYS = 513
_TILE = 8


class FocalMaps:
    """Draws focal maps, keeping the texture for pictures of the same size."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx = ctx
        self._programs = programs
        self._map: moderngl.Texture | None = None

    def draw(self, focus: PictureFocus, area: Area | None = None) -> moderngl.Texture:
        """Draw w_f from the view's base in 1/m, and the pupil's radius relative to the lens's own, over an area of the picture or
        all of it; valid until the next map."""
        program = self._programs.compute("trace/focal_surface.comp", {})
        surface, view = focus.surface, focus.view
        left, top, width, height = area or (0, 0, view.width, view.height)
        texture = self._allocate((width, height))
        with Resources() as scope:
            scope.keep(self._controls(program, "point", surface.controls, _POINTS, view.base_w))
            scope.keep(self._controls(program, "bend", surface.bends, _BENDS, 0.0))
            scope.keep(self._chief_rays(program, focus))
            plane = surface.plane
            set_uniforms(
                program,
                area_first=(left, top),
                centre=(view.cx, view.cy),
                focal_px=(view.fx, view.fy),
                plane=(plane.w0 - view.base_w, plane.slope_x, plane.slope_y),
                blend=surface.blend,
            )
            self._halves(program, focus)
            texture.bind_to_image(_IMAGE, read=False, write=True)
            program.run(-(-width // _TILE), -(-height // _TILE))
            self._ctx.memory_barrier()
        return texture

    def release(self) -> None:
        """Release the memory."""
        if self._map is not None:
            self._map.release()
            self._map = None

    def _controls(
        self, program: moderngl.ComputeShader, name: str, controls: Controls | None, binding: int, base_w: float
    ) -> moderngl.Buffer:
        rows = np.zeros((1, 8), np.float32)
        if controls is not None and len(controls.places):
            rows = np.zeros((len(controls.places), 8), np.float32)
            rows[:, :2], rows[:, 2], rows[:, 3] = controls.places, controls.weights, controls.falloffs
            rows[:, 4 : 4 + controls.values.shape[1]] = controls.values
            rows[:, 4] -= base_w
        set_uniforms(program, **{f"{name}_count": 0 if controls is None else len(controls.places)})
        set_uniforms(program, **{f"{name}_exponent": 3.0 if controls is None else controls.exponent})
        return self._buffer(rows, binding)

    def _chief_rays(self, program: moderngl.ComputeShader, focus: PictureFocus) -> moderngl.Buffer:
        chief = focus.chief
        if chief is None:
            set_uniforms(program, stretch_count=0)
            return self._buffer(np.ones((1, 2), np.float32), _STRETCH)
        last = float(chief.ideal[-1])
        heights = np.linspace(0.0, last, _CHIEF_RAYS)
        heights[0] = 1e-6 * last
        set_uniforms(program, stretch_count=_CHIEF_RAYS, last_height=last)
        return self._buffer(chief.stretch(heights).astype(np.float32), _STRETCH)

    def _halves(self, program: moderngl.ComputeShader, focus: PictureFocus) -> None:
        halves = focus.surface.halves
        edges, ws = np.zeros((MAX_HALVES, 4), np.float32), np.zeros(MAX_HALVES, np.float32)
        for i, half in enumerate(halves):
            edges[i], ws[i] = (*half.direction, half.offset, half.width), half.w - focus.view.base_w
        set_uniforms(program, half_count=len(halves))
        program["half_edges"].write(edges.tobytes())  # type: ignore[union-attr]
        program["half_w"].write(ws.tobytes())  # type: ignore[union-attr]

    def _buffer(self, rows: FloatArray, binding: int) -> moderngl.Buffer:
        buffer = self._ctx.buffer(np.ascontiguousarray(rows, np.float32).tobytes())
        buffer.bind_to_storage_buffer(binding)
        return buffer

    def _allocate(self, size: tuple[int, int]) -> moderngl.Texture:
        if self._map is None or self._map.size != size:
            self.release()
            self._map = self._ctx.texture(size, 2, dtype="f4")
            self._map.filter = (moderngl.NEAREST, moderngl.NEAREST)
        return self._map
