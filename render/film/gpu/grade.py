"""OpenColorIO's transforms on the device, for live pictures. Files are developed by its CPU processor; the two agree.

OpenColorIO writes the transform as GLSL functions with tables in textures; ``film/grade.comp`` calls them for each pixel. The
CDL's
numbers are uniforms, so that they may change in each frame without compiling again.
"""

from __future__ import annotations

import itertools
from collections import OrderedDict
from collections.abc import Iterator
from dataclasses import dataclass

import moderngl
import numpy as np
import PyOpenColorIO as ocio

from render.errors import GraphicsError, SettingsError
from render.film.cdl import Cdl
from render.film.develop import check_exposure
from render.film.grade import Grade
from render.gl.resources import Construction, Resources
from render.gl.shaders import load_source, set_uniforms
from render.model.arrays import FloatArray

_PLACE = "#pragma transform"
_FUNCTIONS = ("timed", "displayed")  # names of the parts in the shader
_TILE = 8
_LIGHT_UNIT = 0
_KEPT = 8  # transforms: a session goes between few


@dataclass(frozen=True, eq=False)
class _Transform:
    """A compiled transform.

    Attributes:
        program: film/grade.comp with OpenColorIO's function in it.
        tables: its textures, by texture unit from 1 on.
    """

    program: moderngl.ComputeShader
    tables: tuple[moderngl.Texture | moderngl.Texture3D, ...]

    def release(self) -> None:
        """Release the memory on the device."""
        for resource in (self.program, *self.tables):
            resource.release()


class DisplayPass:
    """Develops pictures on the device, on the context that it was made for. Transforms are compiled once and kept."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._transforms: OrderedDict[str, _Transform] = OrderedDict()

    def develop(self, light: FloatArray, exposure_scale: float, grade: Grade, space: str | None = None) -> FloatArray:
        """As `render.film.develop`, or with a space as `render.film.project`, to less than 1/255.

        Args:
            light: ``(height, width, 3 or 4)`` float32, linear; a fourth channel is left out. NaN counts as black.
            exposure_scale: factor from the camera's exposure.
            grade: the display, view, looks and CDL.
            space: None for scene-linear light in the working space; else the space of a print's light, as for
                `Grade.processor`.

        Returns:
            ``(height, width, 3)`` float32, encoded for the display, from 0 to 1.

        Raises:
            SettingsError: no such picture or exposure, or OpenColorIO cannot build the transform.
            GraphicsError: OpenGL reports an error.
        """
        if light.ndim != 3 or light.shape[2] not in (3, 4):
            raise SettingsError(f"light must be (height, width, 3) or (height, width, 4), got {light.shape}")
        size, pixels = light.shape[1::-1], np.ascontiguousarray(light, np.float32)
        with Resources() as held:
            source = held.keep(self._ctx.texture(size, light.shape[2], pixels.tobytes(), dtype="f4"))
            target = held.keep(self._ctx.texture(size, 4, dtype="f4"))
            self.run(source, target, exposure_scale, grade, space)
            shown = np.frombuffer(target.read(), np.float32).reshape(*light.shape[:2], 4)
        return np.ascontiguousarray(shown[..., :3])

    def run(
        self,
        source: moderngl.Texture,
        target: moderngl.Texture,
        exposure_scale: float,
        grade: Grade,
        space: str | None = None,
    ) -> None:
        """Develop a texture into another of the same size, whose format may be of floats or bytes; as `develop`."""
        check_exposure(exposure_scale)
        transform = self._transform(grade, space)
        _set_cdl(transform.program, grade.cdl)
        source.use(_LIGHT_UNIT)
        for unit, table in enumerate(transform.tables, start=1):
            table.use(unit)
        transform.program["light"] = _LIGHT_UNIT
        transform.program["exposure"] = exposure_scale
        target.bind_to_image(0, read=False, write=True)
        transform.program.run(-(-target.width // _TILE), -(-target.height // _TILE))
        self._ctx.memory_barrier()

    def release(self) -> None:
        """Release the memory on the device."""
        while self._transforms:
            self._transforms.popitem()[1].release()

    def _transform(self, grade: Grade, space: str | None) -> _Transform:
        parts = grade.processors_around_cdl(space)
        key = " ".join(str(part.getCacheID()) for part in parts)
        if key not in self._transforms:
            self._transforms[key] = _compile(self._ctx, parts)
            if len(self._transforms) > _KEPT:
                self._transforms.popitem(last=False)[1].release()
        self._transforms.move_to_end(key)
        return self._transforms[key]


def _compile(ctx: moderngl.Context, parts: list[ocio.Processor]) -> _Transform:
    """Compile a transform and load its tables.

    Args:
        ctx: of the device.
        parts: the way to the display, in two parts where a CDL works between them.

    Raises:
        GraphicsError: the driver refuses the shader.
    """
    has_cdl = len(parts) == 2
    codes = [_code(part, name) for part, name in zip(parts, _FUNCTIONS[-len(parts) :], strict=True)]
    source = load_source("film/grade.comp", {"CDL": 1} if has_cdl else None)
    with Construction() as scope:
        try:
            text = "\n".join(code.getShaderText() for code in codes)
            program = scope.keep(ctx.compute_shader(source.replace(_PLACE, text)))
        except moderngl.Error as error:
            raise GraphicsError(f"OpenColorIO's transform did not compile: {error}") from error
        tables = []
        for sampler, table in itertools.chain.from_iterable(_tables(ctx, code) for code in codes):
            tables.append(scope.keep(table))
            if sampler in program:
                program[sampler] = len(tables)
    return _Transform(program, tuple(tables))


def _code(processor: ocio.Processor, function: str) -> ocio.GpuShaderDesc:
    """OpenColorIO's code of a part; all its names begin with the function's."""
    code = ocio.GpuShaderDesc.CreateShaderDesc(
        language=ocio.GPU_LANGUAGE_GLSL_4_0, functionName=function, resourcePrefix=f"{function}_"
    )
    code.setAllowTexture1D(False)  # moderngl has none
    processor.getDefaultGPUProcessor().extractGpuShaderInfo(code)
    return code


def _set_cdl(program: moderngl.ComputeShader, cdl: Cdl) -> None:
    set_uniforms(program, slope=cdl.slope, offset=cdl.offset, power=cdl.power, saturation=cdl.saturation)


def _tables(
    ctx: moderngl.Context, code: ocio.GpuShaderDesc
) -> Iterator[tuple[str, moderngl.Texture | moderngl.Texture3D]]:
    """Tables of a transform as textures, each with the name of its sampler; the caller owns them."""
    for table in code.getTextures():
        channels = 1 if table.channel == ocio.GpuShaderDesc.TEXTURE_RED_CHANNEL else 3
        flat = ctx.texture((table.width, table.height), channels, _bytes(table.getValues()), dtype="f4")
        flat.filter = _filter(table.interpolation)
        flat.repeat_x = flat.repeat_y = False
        yield table.samplerName, flat
    for table in code.get3DTextures():
        cube = ctx.texture3d((table.edgeLen,) * 3, 3, _bytes(table.getValues()), dtype="f4")
        cube.filter = _filter(table.interpolation)
        cube.repeat_x = cube.repeat_y = cube.repeat_z = False
        yield table.samplerName, cube


def _bytes(values: FloatArray) -> bytes:
    """A copy: OpenColorIO's own array lives only as long as its shader description."""
    return np.array(values, np.float32).tobytes()


def _filter(interpolation: ocio.Interpolation) -> tuple[int, int]:
    kind = moderngl.NEAREST if interpolation == ocio.INTERP_NEAREST else moderngl.LINEAR
    return (kind, kind)
