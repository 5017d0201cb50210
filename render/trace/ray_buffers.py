"""A ray bundle's buffers and textures on the device, as ``lens/lens_rays.glsl`` reads them."""

from __future__ import annotations

import moderngl
import numpy as np

from render.gl.shaders import set_uniforms
from render.model.arrays import FloatArray
from render.optics.sampling import pattern_mask
from render.trace import lens_table
from render.trace.lens_table import ROW_LENGTH, GridTable, PolynomialTable
from render.trace.rays import RayBundle, RayPattern

_MASK = 7  # as the shader binds it
_POINTS_ACROSS = 1024  # texels of a row, an even number
_ROW_DEFINES = {
    name: getattr(lens_table, name)
    for name in (
        "SLOPE_T",
        "SLOPE_S",
        "PUPIL_T",
        "PUPIL_S",
        "FRONT_RIM",
        "REAR_RIM",
        "WEIGHT",
        "REGION",
        "BOUND",
        "LIGHT",
    )
} | {"HIGHER": ROW_LENGTH, "ROW_VEC4": ROW_LENGTH // 4}
_LINEAR = (moderngl.LINEAR, moderngl.LINEAR)

Defines = dict[str, int | float | str]
Program = moderngl.ComputeShader | moderngl.Program


class RayBuffers:
    """Uploads ray bundles. Buffers and textures of the last bundle are released when the next is bound."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._resources: list[moderngl.Buffer | moderngl.Texture | moderngl.TextureArray] = []
        self._grids: list[tuple[moderngl.TextureArray, moderngl.TextureArray]] = []
        self._unit = 0

    def defines(self, bundle: RayBundle) -> Defines:
        """Shader defines for a ray bundle: the kind of its lens table, its degrees, and whether the iris has a shape."""
        defines: Defines = {"POINTS_ACROSS": _POINTS_ACROSS}
        if bundle.pattern.iris_points is not None:
            defines["SHAPED_IRIS"] = 1
        if isinstance(bundle.table, PolynomialTable):
            defines |= {"POLYNOMIAL_LENS": 1, **_ROW_DEFINES}
            defines |= {"SLOPE_DEGREE": bundle.table.slope_degree, "PUPIL_DEGREE": bundle.table.pupil_degree}
            defines |= {"ROW_VEC4": bundle.table.rows.shape[-1] // 4}
        elif bundle.table is not None:
            side = bundle.table.rays.shape[3]
            defines |= {"GRID_LENS": 1, "BOUND_BY_RAYS": 1, "GRID_INSET": f"{(side - 1) / side:.9f}"}
            if bundle.table.mirrored:
                defines["GRID_MIRRORED"] = 1
        return defines

    def bind(self, program: Program, bundle: RayBundle, *, first_unit: int) -> None:
        """Upload the bundle and set the uniforms that follow from it; textures take units from ``first_unit`` on."""
        self.release()
        pattern, self._unit = bundle.pattern, first_unit
        self._texture(program, "ray_points", _point_texels(pattern))
        self._mask()
        set_uniforms(program, narrowing=(1.0 / bundle.squeeze, 1.0), patterns=pattern.patterns)
        if isinstance(bundle.table, PolynomialTable):
            if pattern.iris_image is not None:
                self._texture(program, "iris_image", pattern.iris_image[..., None])
            self._texture(program, "lens_rows", bundle.table.rows.reshape(-1, bundle.table.rows.shape[-1] // 4, 4))
            set_uniforms(program, row_count=bundle.table.rows.shape[1])
            set_uniforms(program, last_slope=bundle.table.last_slope)
        elif isinstance(bundle.table, GridTable):
            set_uniforms(program, grid_fields=bundle.table.fields)
            set_uniforms(program, grid_slope=bundle.table.last_slope)
            self._grids = [
                (self._array(rays), self._array(light))
                for rays, light in zip(bundle.table.rays, bundle.table.light, strict=True)
            ]
        else:
            set_uniforms(program, pupil_m=bundle.pupil_m)

    def choose_wavelength(self, program: Program, bundle: RayBundle, number: int) -> None:
        """Select the part of the table for one of the bundle's wavelengths."""
        if isinstance(bundle.table, PolynomialTable):
            set_uniforms(program, first_row=number * bundle.table.rows.shape[1])
        elif isinstance(bundle.table, GridTable):
            for name, texture, unit in zip(
                ("grid_rays", "grid_light"), self._grids[number], (self._unit, self._unit + 1), strict=True
            ):
                texture.use(unit)
                set_uniforms(program, **{name: unit})

    def release(self) -> None:
        """Release the memory."""
        for resource in self._resources:
            resource.release()
        self._resources, self._grids = [], []

    def _mask(self) -> None:
        buffer = self._ctx.buffer(pattern_mask().tobytes())
        self._resources.append(buffer)
        buffer.bind_to_storage_buffer(_MASK)

    def _texture(self, program: Program, name: str, values: FloatArray) -> None:
        """Upload ``(height, width, channels)`` values and bind them to the next unit."""
        height, width, channels = values.shape
        texture = self._ctx.texture((width, height), channels, values.astype(np.float32).tobytes(), dtype="f4")
        texture.filter, texture.repeat_x, texture.repeat_y = _LINEAR, False, False
        self._resources.append(texture)
        texture.use(self._unit)
        set_uniforms(program, **{name: self._unit})
        self._unit += 1

    def _array(self, values: FloatArray) -> moderngl.TextureArray:
        slices, height, width, channels = values.shape
        texture = self._ctx.texture_array((width, height, slices), channels, values.tobytes(), dtype="f4")
        texture.filter, texture.repeat_x, texture.repeat_y = _LINEAR, False, False
        self._resources.append(texture)
        return texture


def _point_texels(pattern: RayPattern) -> FloatArray:
    """Points of a pattern as rows of texels, ``(height, width, 4)``; with a shaped iris, the point on it follows."""
    points = pattern.points.reshape(-1, 4)
    if pattern.iris_points is not None:
        on_iris = pattern.iris_points.reshape(-1, 2)
        points = np.stack([points, np.pad(on_iris, ((0, 0), (0, 2)))], axis=1).reshape(-1, 4)
    rows = -(-len(points) // _POINTS_ACROSS)
    return np.pad(points, ((0, rows * _POINTS_ACROSS - len(points)), (0, 0))).reshape(rows, _POINTS_ACROSS, 4)
