"""Film and sensor on the device, for live pictures. Files are developed by numpy (`render.film.process`); the two agree."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import moderngl
import numpy as np

from render.errors import SettingsError
from render.film.balance import balance_gains
from render.film.develop import check_exposure
from render.film.gpu.halation import HalationPass
from render.film.gpu.scratch import Scratch, groups
from render.film.gpu.tables import TableCache
from render.film.grain import GRAIN_SIZE_UM, grain_kernels, grain_scale
from render.film.halation import halation_shares
from render.film.noise import noise_key
from render.film.process import STOP, balance_sensor
from render.film.settings import FilmSettings
from render.film.stock import MIDDLE_GREY
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import DoubleArray

_TILE = 8
_LIGHT, _TABLES = 0, 1  # texture units
_SPREAD, _NOISE = 0, 1  # storage buffers
_BYTES = 16  # of four floats
_ENDLESS = 3e38  # where a sensor that never clips does


@dataclass(frozen=True)
class Exposure:
    """Exposure of the film.

    Attributes:
        scale: factor on the light, from the camera's exposure.
        frame: frame number, for grain and noise.
        gate_mm: width and height of the film that the picture covers.
        seed: seed of the render, beside the film's own.
    """

    scale: float
    frame: int
    gate_mm: tuple[float, float]
    seed: int = 0

    def __post_init__(self) -> None:
        """Check the numbers; raises `SettingsError`."""
        check_exposure(self.scale)
        if not (min(self.gate_mm) > 0 and all(map(math.isfinite, self.gate_mm))):
            raise SettingsError(
                f"a film gate needs a width and a height above 0 mm, got {self.gate_mm[0]:g} x {self.gate_mm[1]:g}"
            )


@dataclass(frozen=True)
class _Recipe:
    """Shader variant of a film, with its uniforms, defines and buffers by binding."""

    uniforms: dict[str, Any]
    defines: dict[str, int | float | str] = field(default_factory=dict)
    buffers: dict[int, moderngl.Buffer] = field(default_factory=dict)


class FilmPass:
    """Develops film on the device, in one context. Buffers and textures are kept between pictures."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache | None = None) -> None:
        self._ctx = ctx
        self._programs = programs or ProgramCache(ctx)
        self._scratch = Scratch(ctx)
        self._tables = TableCache(ctx)
        self._halation = HalationPass(ctx, self._programs)

    def run(self, light: moderngl.Texture, target: moderngl.Texture, film: FilmSettings, exposure: Exposure) -> None:
        """Develop film as `render.film.develop_on_film` does after `render.film.develop.expose`, within 1/255 of the
        shown range.

        Args:
            light: RGB or RGBA floats, scene-linear, not exposed; a fourth channel is left out. NaN counts as black.
            target: RGBA floats, of the same size.
            film: film or sensor.
            exposure: how.

        Raises:
            SettingsError: film or light make no sense.
            GraphicsError: OpenGL rejects a shader, or the picture is too large for it (`TooLargeError`).
        """
        gains = tuple(balance_gains(film.white_balance_k, film.tint).tolist())
        recipe = _Recipe({"light": _LIGHT, "exposure": exposure.scale, "gains": gains})
        if film.process == "digital":
            _add_sensor(recipe, light, film, exposure)
        elif film.process != "none":
            self._add_stock(recipe, film)
            if film.halation.amount > 0:
                self._add_halation(recipe, light, film, exposure)
            if film.grain.amount > 0:
                self._add_grain(recipe, light, film, exposure)
        program = self._programs.compute("film/film_develop.comp", recipe.defines)
        set_uniforms(program, **recipe.uniforms)
        for binding, buffer in recipe.buffers.items():
            buffer.bind_to_storage_buffer(binding)
        light.use(_LIGHT)
        target.bind_to_image(0, read=False, write=True)
        program.run(-(-target.width // _TILE), -(-target.height // _TILE))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Release the memory on the device."""
        self._halation.release()
        self._tables.release()
        self._scratch.release()

    def _add_stock(self, recipe: _Recipe, film: FilmSettings) -> None:
        stock, printed = film.stock, None if film.process == "reversal" else film.print_stock
        if stock is None or (printed is None and film.process != "reversal"):
            raise SettingsError(f"film process {film.process} has no stock, or no print")
        tables = self._tables.tables_of(film)
        recipe.defines["RECORDS"] = len(stock.curves)
        anchor = film.push * STOP - math.log10(MIDDLE_GREY)
        recipe.uniforms.update(
            tables=_TABLES,
            exposure_offset=_three(np.array(stock.middle_log_exposure) + anchor),
            clear=_three((stock if printed is None else printed).base),
        )
        for kind, (begins, steps) in tables.ranges.items():
            recipe.uniforms.update({f"{kind}_begins": _three(begins), f"{kind}_steps": _three(steps)})
        if printed is not None:
            recipe.defines["PRINT"] = 1
            lights = np.array(printed.middle_log_exposure) + np.array(stock.middle_density)
            recipe.uniforms["printer_lights"] = _three(lights)
        tables.texture.use(_TABLES)

    def _add_halation(self, recipe: _Recipe, light: moderngl.Texture, film: FilmSettings, exposure: Exposure) -> None:
        halation = film.halation
        shares = halation_shares(halation.amount, halation.radius_mm, halation.color)
        across, down = _pixel_mm(light, exposure)
        if halation.radius_mm == 0 or not any(shares):
            return
        radius_px = halation.radius_mm / across, halation.radius_mm / down
        spread = self._halation.spread(light, exposure.scale, recipe.uniforms["gains"], radius_px)
        recipe.defines["HALATION"] = 1
        recipe.uniforms.update(shares=shares, reach=spread.reach, spread_width=spread.width)
        recipe.buffers[_SPREAD] = spread.buffer

    def _add_grain(self, recipe: _Recipe, light: moderngl.Texture, film: FilmSettings, exposure: Exposure) -> None:
        across, down = _pixel_mm(light, exposure)
        pixel_um, size_um = (1000 * across, 1000 * down), film.grain.size_um or GRAIN_SIZE_UM
        key = noise_key(exposure.frame, exposure.seed + film.grain.seed)
        recipe.uniforms["grain_scale"] = film.grain.amount * grain_scale(pixel_um, size_um)
        kernels = grain_kernels(pixel_um, size_um)
        if max(map(len, kernels)) == 1:  # all grain lies within its pixel
            recipe.defines["GRAIN"] = 1
            recipe.uniforms["noise_key"] = key
            return
        recipe.defines["SMOOTH_GRAIN"] = 1
        recipe.buffers[_NOISE] = self._smooth_noise(light.size, kernels, key)

    def _smooth_noise(
        self, size: tuple[int, int], kernels: tuple[DoubleArray, DoubleArray], key: tuple[int, int]
    ) -> moderngl.Buffer:
        """Noise under both kernels, row by row."""
        reach = len(kernels[0]) // 2, len(kernels[1]) // 2
        wide = size[0] + 2 * reach[0], size[1] + 2 * reach[1]
        noise = self._scratch.buffer("noise", _BYTES * wide[0] * wide[1])
        program = self._programs.compute("film/film_noise.comp")
        set_uniforms(program, size=wide, first=(-reach[0], -reach[1]), noise_key=key)
        noise.bind_to_storage_buffer(0)
        program.run(groups(wide[0]), wide[1])
        across = self._smooth("across", noise, wide[0], (size[0], wide[1]), kernels[0], 0)
        return self._smooth("down", across, size[0], size, kernels[1], 1)

    def _smooth(
        self,
        name: str,
        source: moderngl.Buffer,
        source_width: int,
        size: tuple[int, int],
        kernel: DoubleArray,
        axis: int,
    ) -> moderngl.Buffer:
        self._ctx.memory_barrier()
        target = self._scratch.buffer(name, _BYTES * size[0] * size[1])
        weights = self._scratch.buffer(f"{name} weights", 4 * len(kernel))
        weights.write(kernel.astype(np.float32).tobytes())
        program = self._programs.compute("film/film_smooth.comp", {"AXIS": axis})
        set_uniforms(program, size=size, source_width=source_width)
        for binding, buffer in enumerate((source, target, weights)):
            buffer.bind_to_storage_buffer(binding)
        program.run(groups(size[0]), size[1])
        self._ctx.memory_barrier()
        return target


def _add_sensor(recipe: _Recipe, light: moderngl.Texture, film: FilmSettings, exposure: Exposure) -> None:
    sensor = balance_sensor(film)
    recipe.defines["SENSOR"] = 1
    recipe.uniforms.update(
        electrons=tuple(sensor.electrons_per_light.tolist()),
        read_variance=sensor.read_noise_e**2,
        averaged=sensor.photosites_in_a_pixel(light.width, light.height),
        clip=min(sensor.clip, _ENDLESS),
        noise_key=noise_key(exposure.frame, exposure.seed + film.grain.seed),
    )


def _pixel_mm(light: moderngl.Texture, exposure: Exposure) -> tuple[float, float]:
    return exposure.gate_mm[0] / light.width, exposure.gate_mm[1] / light.height


def _three(numbers: Any) -> tuple[float, float, float]:
    """One number for each channel; a black-and-white stock's one for all."""
    red, green, blue = np.broadcast_to(np.asarray(numbers, np.float64), 3).tolist()
    return red, green, blue
