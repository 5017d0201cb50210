"""Ray bundles, the tracer's model of a lens: where a pixel's rays pass the pupil, and how the lens bends them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from render.disk_cache import ArrayCache, Arrays
from render.model.arrays import DoubleArray, FloatArray
from render.model.camera import Camera
from render.model.lens import IrisShape
from render.optics.iris import transmission
from render.optics.sampling import lens_samples, ray_range
from render.optics.thin_lens import pupil_radius_m
from render.trace.adaptive import RayBudget
from render.trace.lens_table import GridTable, PolynomialTable

IRIS_IMAGE_SIDE = 256
_cache = ArrayCache("ray-pattern", ("model", "optics", "trace"))


@dataclass(frozen=True, eq=False)
class RayPattern:
    """Start points of rays, as the shaders read them.

    Attributes:
        points: ``(n, patterns, 4)`` float32: a point of the unit disc and the offset on the sensor, -0.5 to 0.5 pixels; y down.
        iris_points: ``(n, patterns, 2)`` float32 points on the stop, y down, where the iris is not round; else None.
        iris_image: ``(side, side)`` float32 transmission relative to its mean on the disc, row 0 at the top; None if round.
        stands_for: rays of the whole pattern of which this is a part, or mean rays of an adaptive one; 0 where it is the whole.
        budget: rays of a picture whose pixels do not all have those of the pattern; None where they have.
    """

    points: FloatArray
    iris_points: FloatArray | None = None
    iris_image: FloatArray | None = None
    stands_for: int = 0
    budget: RayBudget | None = None

    @property
    def count(self) -> int:
        """Rays per pixel, at most."""
        return len(self.points)

    @property
    def patterns(self) -> int:
        """Number of patterns: that of `render.optics.sampling.pattern_mask`, or one for all pixels."""
        return int(self.points.shape[1])

    @property
    def whole(self) -> int:
        """Rays per pixel of the whole pattern."""
        return self.stands_for or self.count

    def part(self, index: int, parts: int) -> RayPattern:
        """One of several runs of successive rays: together the parts are the pattern.

        Args:
            index: index of the part, from 0.
            parts: number of parts, at most the number of rays.
        """
        if parts == 1:
            return self
        run = ray_range(self.count, index, parts)
        iris_points = None if self.iris_points is None else self.iris_points[run]
        return replace(self, points=self.points[run], iris_points=iris_points, stands_for=self.whole)


@dataclass(frozen=True, eq=False)
class RayBundle:
    """Rays of a lens.

    Attributes:
        pattern: start points.
        pupil_m: half axes of the entrance pupil, right and up, metres.
        table: lens table; None for a lens without errors.
        rgb: ``(k, 3)`` share of each channel carried by each of the table's wavelengths; columns sum to 1.
        transmittance: share of light that passes.
        squeeze: anamorphic squeeze, by which a table's rays are narrower from side to side.
    """

    pattern: RayPattern
    pupil_m: tuple[float, float]
    table: PolynomialTable | GridTable | None = None
    rgb: DoubleArray = field(default_factory=lambda: np.ones((1, 3)))
    transmittance: float = 1.0
    squeeze: float = 1.0

    @property
    def count(self) -> int:
        """Rays per pixel (and wavelength)."""
        return self.pattern.count

    @property
    def slope_reach(self) -> float:
        """Largest error of a ray's slope in the plane of focus."""
        return self.table.slope_reach if self.table is not None else 0.0

    @property
    def reach_m(self) -> float:
        """Greatest distance at which a ray passes from the pupil's centre, metres."""
        return self.table.pupil_reach_m if self.table is not None else max(self.pupil_m)


def make_ray_pattern(rays: int, iris: IrisShape, *, seed: int = 0, tiled: bool = True) -> RayPattern:
    """Make the pattern of ``rays`` rays through an iris; see `render.optics.sampling`.

    Raises:
        SettingsError: rays or seed is out of range, or the iris passes no light.
    """
    if rays == 1:
        arrays: Arrays = _pattern_arrays(rays, iris, seed, tiled)
    else:
        arrays = _cache.get(lambda: _pattern_arrays(rays, iris, seed, tiled), rays, iris, seed, tiled)
    return RayPattern(arrays["points"], arrays.get("iris_points"), arrays.get("iris_image"))


def _pattern_arrays(rays: int, iris: IrisShape, seed: int, tiled: bool) -> dict[str, FloatArray]:
    """Compute the arrays of a `RayPattern`, by the names of its attributes."""
    samples = lens_samples(rays, iris, seed=seed, tiled=tiled)
    points = _by_ray(np.concatenate([_downward(samples.disc), samples.pixel], axis=-1))
    if samples.pupil is samples.disc:
        return {"points": points}
    return {
        "points": points,
        "iris_points": _by_ray(_downward(samples.pupil)),
        "iris_image": _relative_transmission(iris),
    }


def make_adaptive_pattern(budget: RayBudget, iris: IrisShape, *, seed: int = 0) -> RayPattern:
    """Make the pattern of rays that are distributed over a picture.

    Raises:
        SettingsError: rays or seed is out of range, or the iris passes no light.
    """
    pattern = make_ray_pattern(budget.most, iris, seed=seed)
    return replace(pattern, stands_for=budget.rays, budget=budget)


def make_thin_lens_bundle(camera: Camera, pattern: RayPattern) -> RayBundle:
    """Rays of the camera's thin lens; the rays of a pinhole all pass one point."""
    radius = pupil_radius_m(camera)
    return RayBundle(pattern, (radius / camera.lens.squeeze, radius), transmittance=camera.lens.transmittance)


def _downward(points: DoubleArray) -> DoubleArray:
    return np.asarray(points * [1.0, -1.0])


def _by_ray(points: DoubleArray) -> FloatArray:
    """Order points ``(patterns, n, k)`` ray by ray, so that neighbouring pixels read neighbouring memory."""
    return np.ascontiguousarray(points.swapaxes(0, 1), np.float32)


def _relative_transmission(iris: IrisShape) -> FloatArray:
    image: DoubleArray = transmission(iris, IRIS_IMAGE_SIDE)
    return np.asarray(image / (image.mean() * 4 / np.pi), np.float32)
