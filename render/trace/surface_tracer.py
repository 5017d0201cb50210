"""Rays from the film through a lens and out into the scene, on the device: ``lens/lens_trace.comp``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.gl.resources import Resources
from render.gl.shaders import ProgramCache, set_uniforms
from render.model.arrays import DoubleArray, FloatArray
from render.model.lens import HeightField
from render.optics.glass import refractive_index
from render.optics.prescription.diffraction import reduced_mm
from render.optics.prescription.focusing import FocusedLens
from render.optics.prescription.paraxial import paraxial_system, transfer
from render.optics.prescription.surface_shape import curvature_across

MAX_WAVELENGTHS = 65  # those of a spectrum, and the d line to measure colour errors from
RAY_BYTES = 32
"""Memory on the device of what is found of a ray."""
_ROW = 20  # numbers of a ``LensSurface``; 12 aspheric terms in the middle
_BICONIC = 4  # more numbers, for the curve from side to side
_OUTLINES = 8  # more numbers behind that, for opening and obscuration
_POLYGONS = 4  # more behind that, for the corners of polygons
_ODD = 16  # more of one with odd powers: 12 terms and their count
_PHASES = 16  # more behind that of one with diffractive surfaces, likewise
_TORI = {"": 0, "upright": 1, "across": 2}
_GROUP = 64


@dataclass(frozen=True, eq=False)
class TracedLens:
    """Rays as they leave a lens, for each wavelength and query.

    Attributes:
        slope: ``(k, n, 2)`` in object space, m of x to a m of depth.
        pupil_mm: ``(k, n, 2)`` where the ray passes the plane of the entrance pupil.
        front: ``(k, n)`` clearance before the stop, (r / half clear diameter)² − 1 at its largest: above 0 a rim blocks.
        rear: ``(k, n)`` the same behind the stop.
        weight: ``(k, n)`` projected solid angle on the film of an element of the stop, 1/mm².
        passed: ``(k, n)`` whether the ray passes, ignoring rims.
    """

    slope: DoubleArray
    pupil_mm: DoubleArray
    front: DoubleArray
    rear: DoubleArray
    weight: DoubleArray
    passed: NDArray[np.bool_]


class SurfaceTracer:
    """Traces rays through focused lenses."""

    def __init__(self, ctx: moderngl.Context, programs: ProgramCache) -> None:
        self._ctx = ctx
        self._programs = programs

    def trace(
        self,
        lens: FocusedLens,
        film_mm: DoubleArray,
        stop_mm: DoubleArray,
        wavelengths_nm: Sequence[float],
        height_field: HeightField | None = None,
    ) -> TracedLens:
        """Trace the ray from each film point through the stop point beside it.

        Args:
            lens: the lens as focused.
            film_mm: ``(n, 2)`` on the film.
            stop_mm: ``(n, 2)`` on the stop, in the same frame.
            wavelengths_nm: up to `MAX_WAVELENGTHS`.
            height_field: heights on the first and the last surface of glass.
        """
        count = len(film_mm)
        program = self._program(lens, height_field)
        queries = np.concatenate([film_mm, stop_mm], axis=1).astype(np.float32)
        near_axis = [_film_to_stop(lens, wavelength) for wavelength in wavelengths_nm]
        set_uniforms(
            program,
            query_count=count,
            surface_count=len(lens.prescription.surfaces),
            stop_index=lens.stop,
            entrance_mm=float(lens.entrance_pupil_mm - lens.vertices_mm[0]),
            stop_mm=lens.stop_radius_mm,
            to_stop=near_axis + [(0.0, 1.0)] * (MAX_WAVELENGTHS - len(near_axis)),
        )
        if lens.prescription.is_diffractive:
            lengths = [float(reduced_mm(wavelength)) for wavelength in wavelengths_nm]
            set_uniforms(program, reduced=lengths + [0.0] * (MAX_WAVELENGTHS - len(lengths)))
        with Resources() as scope:
            for binding, values in enumerate((_surfaces(lens, height_field), _indices(lens, wavelengths_nm), queries)):
                scope.keep(self._ctx.buffer(values.tobytes())).bind_to_storage_buffer(binding)
            if lens.prescription.polygons:
                scope.keep(self._ctx.buffer(_corners(lens).tobytes())).bind_to_storage_buffer(4)
            answers = scope.keep(self._ctx.buffer(reserve=len(wavelengths_nm) * count * RAY_BYTES))
            answers.bind_to_storage_buffer(3)
            self._bind_heights(scope, program, height_field)
            program.run(-(-count // _GROUP), len(wavelengths_nm))
            self._ctx.memory_barrier()
            found = np.frombuffer(answers.read(), np.float32).reshape(len(wavelengths_nm), count, 8)
        return _unpack(found)

    def _program(self, lens: FocusedLens, height_field: HeightField | None) -> moderngl.ComputeShader:
        defines = {"MAX_WAVELENGTHS": MAX_WAVELENGTHS}
        if height_field is not None:
            defines["HEIGHT_FIELD"] = 1
        if lens.prescription.is_anamorphic:
            defines["BICONIC"] = 1
        if lens.prescription.has_tori:
            defines["TORIC"] = 1
        if lens.prescription.outlines:
            defines["OUTLINES"] = 1
        if lens.prescription.polygons:
            defines["POLYGONS"] = 1
        if lens.prescription.has_odd_powers:
            defines["ODD_POWERS"] = 1
        if lens.prescription.is_diffractive:
            defines["PHASES"] = 1
        return self._programs.compute("lens/lens_trace.comp", defines)

    def _bind_heights(self, scope: Resources, program: moderngl.ComputeShader, field: HeightField | None) -> None:
        if field is None:
            return
        for unit, heights in enumerate((field.front, field.back)):
            image = np.zeros((1, 1)) if heights is None else heights
            pixels = image.astype(np.float32).tobytes()
            texture = scope.keep(self._ctx.texture(image.shape[::-1], 1, pixels, dtype="f4"))
            texture.filter, texture.repeat_x, texture.repeat_y = (moderngl.LINEAR, moderngl.LINEAR), False, False
            texture.use(unit)
        set_uniforms(program, heights=[0, 1])


def _unpack(found: FloatArray) -> TracedLens:
    values = found.astype(np.float64)
    return TracedLens(
        slope=values[..., 0:2],
        pupil_mm=values[..., 2:4],
        front=values[..., 4],
        rear=values[..., 5],
        weight=values[..., 6],
        passed=values[..., 7] > 0,
    )


def _surfaces(lens: FocusedLens, field: HeightField | None) -> FloatArray:
    """``(n, 20)`` as ``LensSurface`` in ``lens/lens_surface.glsl``; longer rows with cylinders, outlines or odd powers."""
    surfaces, prescription = lens.prescription.surfaces, lens.prescription
    is_biconic, is_odd = prescription.is_anamorphic, prescription.has_odd_powers
    outlined = _ROW + _BICONIC * is_biconic
    polygons = outlined + (_OUTLINES if prescription.outlines else 0)
    odd = polygons + (_POLYGONS if prescription.polygons else 0)
    phases = odd + _ODD * is_odd
    width = phases + _PHASES * prescription.is_diffractive
    table = np.zeros((len(surfaces), width), np.float32)
    gaps, corners = np.diff(np.append(lens.vertices_mm, lens.film_mm)), 0
    for row, surface, gap in zip(table, surfaces, gaps, strict=True):
        # negative: the iris is not a rim here; the caller knows which stop points are open
        rim = -surface.semi_diameter_mm if surface.is_stop else surface.semi_diameter_mm
        row[:4] = [1 / surface.radius_mm if surface.radius_mm else 0.0, rim, surface.conic, gap]
        row[4 : 4 + len(surface.aspheric)] = surface.aspheric
        row[16] = len(surface.aspheric)
        if is_biconic:
            conic = surface.conic if surface.across is None else surface.across.conic
            row[20:24] = [curvature_across(surface), conic, surface.across is not None, _TORI[surface.torus]]
        for place, outline in enumerate((surface.opening, surface.obscuration)):
            if outline is not None:
                wide, high = outline.half_mm
                begin = outlined + 4 * place
                row[begin : begin + 4] = [-wide if outline.kind == "rectangle" else wide, high, *outline.centre_mm]
            if outline is not None and outline.kind == "polygon":
                row[polygons + 2 * place : polygons + 2 * place + 2] = [corners, len(outline.corners_mm)]
                corners += len(outline.corners_mm)
        if is_odd:
            row[odd : odd + len(surface.odd)] = surface.odd
            row[odd + 12] = len(surface.odd)
        if surface.phase:
            row[phases : phases + len(surface.phase)] = surface.phase
            row[phases + 12] = len(surface.phase)
    if field is not None:
        glass = [place for place, surface in enumerate(surfaces) if surface.radius_mm or not surface.is_stop]
        for index, (place, heights) in enumerate(zip((glass[0], glass[-1]), (field.front, field.back), strict=True)):
            if heights is not None:
                table[place, 17:20] = [1 + index, heights.min(), heights.max()]
    return table


def _corners(lens: FocusedLens) -> FloatArray:
    """Corners ``(n, 2)`` of all polygons, in the order of the surfaces, openings first."""
    return np.array([corner for outline in lens.prescription.polygons for corner in outline.corners_mm], np.float32)


def _indices(lens: FocusedLens, wavelengths_nm: Sequence[float]) -> FloatArray:
    """``(k, n + 1)`` before the first surface and behind each."""
    glasses = [surface.glass for surface in lens.prescription.surfaces]
    rows = [[1.0, *(refractive_index(glass, wavelength) for glass in glasses)] for wavelength in wavelengths_nm]
    return np.asarray(rows, np.float32)


def _film_to_stop(lens: FocusedLens, wavelength_nm: float) -> tuple[float, float]:
    """Near the axis, ``stop point = x · film point + y · slope``; slopes here are toward the scene."""
    system = paraxial_system(lens.prescription, wavelength_nm, lens.vertices_mm)
    (_, b), (_, d) = transfer(system, lens.stop, len(lens.vertices_mm), to_mm=lens.film_mm)
    return float(d), float(b)
