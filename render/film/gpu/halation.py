"""Halation on the device: the light's Fourier transform times the kernel's. See `render.film.halation`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import moderngl
import numpy as np

from render.film.gpu.scratch import Scratch, groups
from render.film.halation import halation_kernel
from render.gl.shaders import Defines, ProgramCache, set_uniforms

_RADICES = (5, 4, 3, 2)
_BYTES = 16  # of two complex numbers


@dataclass(frozen=True)
class Spread:
    """Light as the base spreads it.

    Attributes:
        buffer: RGB and nothing, row by row, on the device; the pass's own.
        width: of its rows.
        reach: position of the picture's corner in it.
    """

    buffer: moderngl.Buffer
    width: int
    reach: tuple[int, int]


class HalationPass:
    """Spreads light by the kernel of halation, on the context that it was made for."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx, self._programs = ctx, programs
        self._scratch = Scratch(ctx)
        self._spectrum: tuple[tuple[object, ...], moderngl.Buffer] | None = None

    def spread(
        self, light: moderngl.Texture, exposure: float, gains: tuple[float, ...], radius_px: tuple[float, float]
    ) -> Spread:
        """Light under the kernel, the picture mirrored at its edges.

        Args:
            light: RGB or RGBA floats.
            exposure: factor on the light.
            gains: then each channel.
            radius_px: of the ring, across and down.

        Returns:
            It lasts until the next call.
        """
        rows, columns = halation_kernel(*radius_px).shape
        reach = (columns // 2, rows // 2)
        size = _fast_size(light.width + 2 * reach[0]), _fast_size(light.height + 2 * reach[1])
        one, other = (self._scratch.buffer(name, _BYTES * size[0] * size[1]) for name in ("one", "other"))
        pad = self._programs.compute("film/film_pad.comp")
        light.use(0)
        one.bind_to_storage_buffer(0)
        set_uniforms(pad, light=0, exposure=exposure, gains=gains, size=size, reach=reach)
        pad.run(groups(size[0]), size[1])
        self._spectrum_of(radius_px, size).bind_to_storage_buffer(2)
        for axis, direction in ((0, -1.0), (1, -1.0), (1, 1.0), (0, 1.0)):
            one, other = self._transform(one, other, size, axis, direction)
        self._ctx.memory_barrier()
        return Spread(one, size[0], reach)

    def release(self) -> None:
        """Release the memory on the device."""
        self._scratch.release()
        if self._spectrum is not None:
            self._spectrum[1].release()
            self._spectrum = None

    def _transform(
        self, source: moderngl.Buffer, target: moderngl.Buffer, size: tuple[int, int], axis: int, direction: float
    ) -> tuple[moderngl.Buffer, moderngl.Buffer]:
        """Transform along an axis; the buffer that holds it, and the other one."""
        done = 1
        for radix in _radices(size[axis]):
            defines: dict[str, int | float | str] = {"RADIX": radix, "ROOTS": _roots(radix), "AXIS": axis}
            if done == 1 and axis == 1 and direction > 0:  # the first stage of the way back
                defines["SPECTRUM"] = 1
            self._stage(defines, source, target, size, done, direction)
            source, target, done = target, source, done * radix
        return source, target

    def _stage(
        self,
        defines: Defines,
        source: moderngl.Buffer,
        target: moderngl.Buffer,
        size: tuple[int, int],
        done: int,
        direction: float,
    ) -> None:
        self._ctx.memory_barrier()
        program = self._programs.compute("film/fourier.comp", defines)
        source.bind_to_storage_buffer(0)
        target.bind_to_storage_buffer(1)
        set_uniforms(program, size=size, done=done, direction=direction)
        axis, radix = int(defines["AXIS"]), int(defines["RADIX"])
        threads = [size[0], size[1]]
        threads[axis] //= radix
        program.run(groups(threads[0]), threads[1])

    def _spectrum_of(self, radius_px: tuple[float, float], size: tuple[int, int]) -> moderngl.Buffer:
        """The kernel's transform, which is real as the kernel is even, over the number of places."""
        key = (radius_px, size)
        if self._spectrum is None or self._spectrum[0] != key:
            kernel = halation_kernel(*radius_px)
            laid = np.zeros(size[::-1])
            laid[: kernel.shape[0], : kernel.shape[1]] = kernel
            laid = np.roll(laid, (-(kernel.shape[0] // 2), -(kernel.shape[1] // 2)), (0, 1))
            spectrum = (np.fft.fft2(laid).real / (size[0] * size[1])).astype(np.float32)
            buffer = self._ctx.buffer(spectrum.tobytes())
            if self._spectrum is not None:
                self._spectrum[1].release()
            self._spectrum = key, buffer
        return self._spectrum[1]


def _fast_size(size: int) -> int:
    """The least length from ``size`` up that has no prime factor above 5."""
    while math.prod(_radices(size)) != size:
        size += 1
    return size


def _radices(size: int) -> list[int]:
    """Radices of the stages of a transform, whose product is its length where that has no prime factor above 5."""
    found = []
    for radix in _RADICES:
        while size % radix == 0:
            found.append(radix)
            size //= radix
    return found


def _roots(radix: int) -> str:
    """The roots of unity, as GLSL writes them."""
    turns = [2 * math.pi * k / radix for k in range(radix)]
    return ", ".join(f"vec2({math.cos(turn):.9f}, {math.sin(turn):.9f})" for turn in turns)
