"""Gaussian splats: clouds of soft ellipsoids of light, as captured sets are (Kerbl et al. 2023, "3D Gaussian Splatting")."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.model.arrays import DoubleArray, FloatArray, IntArray, LongArray

MAX_SPLATS = 5_000_000
"""Limit on the splats of a scene, instances counted: some 110 bytes each, and twice as much with third-degree harmonics."""
LEAST_OPACITY = 1 / 255
"""Opacity below which a splat, and the skirt of one, is left out, as in Kerbl et al."""
MOST_OPACITY = 0.99
"""Limit on the opacity of a splat, likewise."""
MOST_MATTE_CLOUDS = 15
"""Clouds that mattes tell apart; as in ``trace/splat_planes.glsl``."""


@dataclass(frozen=True, eq=False)
class SplatCloud:
    """Splats of one prim. Each has the density ``exp(-|A⁻¹ (x - p)|² / 2)`` around its position p, with A its axes.

    Attributes:
        positions: ``(n, 3)`` float32 metres, in the space that the batch's poses map to the world.
        axes: ``(n, 3, 3)`` float32 metres; the columns are the ellipsoid's axes, one standard deviation long.
        opacities: ``(n,)`` float32 in the middle, 0 to 1.
        harmonics: ``(n, k, 3)`` float32 coefficients of the real spherical harmonics of red, green and blue, with k = 1, 4, 9 or
            16, in the order and with the signs of Kerbl et al.; they are added to a grey of 0.5.
        is_encoded: whether their sum is encoded by sRGB's transfer function; linear otherwise.
        to_working: ``(3, 3)`` working space from the linear colours, for columns.
        numbers: ``(n,)`` number of each in the prim's own list; None where all of that are here.
    """

    positions: FloatArray
    axes: FloatArray
    opacities: FloatArray
    harmonics: FloatArray
    is_encoded: bool = True
    to_working: DoubleArray | None = None
    numbers: LongArray | None = None


@dataclass(frozen=True, eq=False)
class SplatBatch:
    """A cloud and where its instances stand.

    Attributes:
        cloud: the splats.
        poses: ``(k, 4, 4)`` float64 world from the cloud's space, one for each instance.
        prim_id: index into ``Scene.prim_paths`` of the prim that they are picked as.
        source_id: the same of the prim that the cloud is.
        instance_numbers: ``(k,)`` number of each instance, as `render.model.scene.Batch.instance_numbers`; None where they are no
            instances of a PointInstancer.
        is_holdout: whether they hide what is behind them without light or coverage of theirs.
    """

    cloud: SplatCloud
    poses: DoubleArray
    prim_id: int = 0
    source_id: int = 0
    instance_numbers: IntArray | None = None
    is_holdout: bool = False

    @property
    def count(self) -> int:
        """Splats of all instances."""
        return len(self.cloud.positions) * len(self.poses)


def is_usable(cloud: SplatCloud) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether each splat ``(n,)`` has finite numbers and an opacity above 0."""
    finite = np.isfinite(cloud.positions).all(axis=1) & np.isfinite(cloud.axes).all(axis=(1, 2))
    finite &= np.isfinite(cloud.harmonics).all(axis=(1, 2)) & np.isfinite(cloud.opacities)
    return np.asarray(finite & (cloud.opacities > 0))
