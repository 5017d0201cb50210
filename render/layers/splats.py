"""Gaussian splats as a view sees them: ellipses with a colour and an opacity, far to near.

A splat's ellipsoid is projected by the derivative of the projection at its centre (Zwicker et al. 2001, "EWA Volume Splatting",
section 4), and widened by a low-pass filter of 0.3 square pixels of the picture, as in Kerbl et al. 2023, "3D Gaussian Splatting
for Real-Time Radiance Field Rendering", section 4 and its reference rasteriser, which captured clouds are fitted with.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from render.model.arrays import BoolArray, DoubleArray, FloatArray, LongArray
from render.model.splats import LEAST_OPACITY, MOST_OPACITY, SplatBatch, SplatCloud
from render.optics.view import PinholeView

LOW_PASS_PX2 = 0.3
"""Variance that is added to an ellipse along each axis, square pixels of the picture."""
HELD_OUT = 1 << 20
"""Number in place of the batch's of splats that are held out."""
_BEYOND_VIEW = 1.3
"""Slopes, relative to those at the view's edge, at which the derivative is taken at most, as in Kerbl et al."""
_LEAST_PX2, _MOST_PX2 = 1e-12, 1e30
"""Limits on the variance of an ellipse, square pixels: a larger one is left out."""
_FARTHEST_EYE = 1e15
"""Limit on the distance of the eye in a cloud's space, whose square float32 holds; directions are the same beyond."""
_HARMONICS = (
    0.28209479177387814,
    0.4886025119029199,
    (1.0925484305920792, 0.31539156525252005, 0.5462742152960396),
    (0.5900435899266435, 2.890611442640554, 0.4570457994644658, 0.3731763325901154, 1.445305721320277),
)
"""Factors of the real spherical harmonics of degree 0 to 3."""


@dataclass(frozen=True, eq=False)
class ProjectedSplats:
    """Splats in a view, far to near.

    Attributes:
        records: ``(n, 12)`` float32 as ``splats/splat.vert`` reads them: centre in pixels, w from the view's base (1/m), opacity;
            Cholesky factor of the covariance in pixels (xx, yx, yy), radius in standard deviations; colour, number of the batch,
            or `HELD_OUT`.
        view: view that they are projected in.
    """

    records: FloatArray
    view: PinholeView

    @property
    def w(self) -> FloatArray:
        """``(n,)`` inverse depth of each, 1/m, ascending."""
        return np.asarray(self.records[:, 2])

    @property
    def owners(self) -> LongArray:
        """``(n,)`` number of the batch of each, or `HELD_OUT`."""
        return self.records[:, 11].astype(np.int64)


def project_splats(batches: Sequence[SplatBatch], view: PinholeView, low_pass_px2: float) -> ProjectedSplats:
    """Project the splats that a view sees.

    Args:
        batches: the scene's.
        view: the view.
        low_pass_px2: variance that ellipses are widened by, square pixels of the view.
    """
    parts = [np.zeros((0, 12), np.float32)]
    for number, batch in enumerate(batches):
        for pose in batch.poses:
            parts.append(_project(batch.cloud, pose, view, low_pass_px2)[0])
            parts[-1][:, 11] = number
            if batch.is_holdout:
                parts[-1][:, 8:] = 0, 0, 0, HELD_OUT
    records = np.concatenate(parts)
    return ProjectedSplats(records[np.argsort(records[:, 2], kind="stable")], view)


def nearest_splat_w(batches: Sequence[SplatBatch], view: PinholeView) -> float:
    """Largest inverse depth of a splat's centre in view, from the view's base, 1/m; 0 where there is none."""
    nearest_w = 0.0
    for batch in batches:
        for pose in batch.poses:
            places = _in_camera(batch.cloud, pose, view)
            pixels, _ = _pixels(places, view)
            seen = _is_drawn(batch.cloud, places, view)
            seen &= (pixels >= 0).all(axis=1) & (pixels <= view.size).all(axis=1)
            if seen.any():
                nearest_w = max(nearest_w, 1.0 / float(-places[seen, 2].max()) - view.base_w)
    return nearest_w


@dataclass(frozen=True)
class HidingSplat:
    """Splat at which opacity passes one half.

    Attributes:
        depth_m: its depth, metres.
        batch: its batch.
        pose: which of the batch's poses it stands at.
        number: its number in the prim's own list.
    """

    depth_m: float
    batch: SplatBatch
    pose: int
    number: int


def splat_in_middle(batches: Sequence[SplatBatch], view: PinholeView) -> HidingSplat | None:
    """Find the splat at which they hide half of what lies behind, in the middle of a view.

    Args:
        batches: the scene's splats.
        view: view of one pixel.
    """
    w, opacities, owners = [np.zeros(0)], [np.zeros(0)], [np.zeros((0, 3), np.int64)]
    for which, batch in enumerate(batches):
        for number, pose in enumerate(batch.poses):
            drawn, rows = _project(batch.cloud, pose, view, LOW_PASS_PX2)
            records = drawn.astype(np.float64)
            across = (view.width / 2 - records[:, 0]) / records[:, 4]
            down = (view.height / 2 - records[:, 1] - records[:, 5] * across) / records[:, 6]
            w.append(records[:, 2])
            opacities.append(records[:, 3] * np.exp(-(across**2 + down**2) / 2))
            owners.append(np.stack([np.full(len(rows), which), np.full(len(rows), number), rows], axis=1))
    near_to_far = np.argsort(-np.concatenate(w), kind="stable")
    hidden = np.flatnonzero(np.cumprod(1 - np.concatenate(opacities)[near_to_far]) <= 0.5)
    if not len(hidden):
        return None
    found = near_to_far[hidden[0]]
    which, number, row = np.concatenate(owners)[found].tolist()
    batch, depth_m = batches[which], 1 / (float(np.concatenate(w)[found]) + view.base_w)
    numbers = batch.cloud.numbers
    return HidingSplat(depth_m, batch, number, row if numbers is None else int(numbers[row]))


def colours_towards(cloud: SplatCloud, rows: LongArray, eye: DoubleArray) -> FloatArray:
    """Colour ``(n, 3)`` of splats in the working space as an eye sees them: spherical harmonics at the direction to them.

    Args:
        cloud: the splats.
        rows: ``(n,)`` which of them.
        eye: ``(3,)`` in the cloud's space, metres.
    """
    coefficients = cloud.harmonics[rows]
    basis = _basis((cloud.positions[rows] - eye).astype(np.float32), coefficients.shape[1])
    encoded = np.maximum(np.einsum("nk,nkc->nc", basis, coefficients) + 0.5, 0.0)
    linear = _decode(encoded) if cloud.is_encoded else encoded
    return linear if cloud.to_working is None else (linear @ cloud.to_working.T).astype(np.float32)


def _project(
    cloud: SplatCloud, pose: DoubleArray, view: PinholeView, low_pass_px2: float
) -> tuple[FloatArray, LongArray]:
    """Records of one instance, and which of the cloud's splats they are, in its order."""
    places = _in_camera(cloud, pose, view)
    rows = np.flatnonzero(_is_drawn(cloud, places, view))
    places = places[rows]
    pixels, slopes = _pixels(places, view)
    depth = -places[:, 2]
    opacity = np.minimum(cloud.opacities[rows], MOST_OPACITY)
    reach = np.sqrt(2 * np.log(opacity / LEAST_OPACITY))
    right, up, back = _turned(cloud.axes[rows], view.camera_from_world[:3, :3] @ pose[:3, :3])
    most = _BEYOND_VIEW * _edge_slopes(view)
    x, y = np.clip(slopes, -most, most).astype(np.float32).T[..., None]
    per_depth = (1 / depth).astype(np.float32)[:, None]
    right, up = (right + x * back) * per_depth, (up + y * back) * per_depth
    xx, xy, yx, yy = view.shear
    across, down = view.fx * (xx * right + xy * up), -view.fy * (yx * right + yy * up)
    with np.errstate(over="ignore"):
        spread_x, spread_y = ((part * part).sum(axis=1) + max(low_pass_px2, _LEAST_PX2) for part in (across, down))
    wide, high = reach * np.sqrt(spread_x), reach * np.sqrt(spread_y)
    seen = (spread_x < _MOST_PX2) & (spread_y < _MOST_PX2)
    seen &= (pixels[:, 0] > -wide) & (pixels[:, 0] < view.width + wide)
    seen &= (pixels[:, 1] > -high) & (pixels[:, 1] < view.height + high)
    first = np.sqrt(spread_x[seen])
    between = (across[seen] * down[seen]).sum(axis=1) / first
    eye = _eye_in(view.camera_from_world @ pose, view)
    records = np.zeros((int(seen.sum()), 12), np.float32)
    records[:, :2] = pixels[seen]
    records[:, 2] = 1 / depth[seen] - view.base_w
    records[:, 3] = opacity[seen]
    records[:, 4], records[:, 5] = first, between
    records[:, 6] = np.sqrt(np.maximum(spread_y[seen] - between * between, 1e-6 * spread_y[seen]))
    records[:, 7] = reach[seen]
    records[:, 8:11] = colours_towards(cloud, rows[seen], eye)
    return records, rows[seen]


def _eye_in(camera_from_cloud: DoubleArray, view: PinholeView) -> DoubleArray:
    """The view's eye ``(3,)`` in a cloud's space; of one that is flattened, the nearest place that is mapped to it."""
    # the cutoff leaves a space that is stretched by less as it is
    own = np.linalg.pinv(camera_from_cloud[:3, :3], rcond=1e-9)
    eye = own @ ([view.eye_x_m, view.eye_y_m, 0.0] - camera_from_cloud[:3, 3])
    return np.asarray(eye * min(1.0, _FARTHEST_EYE / max(float(np.abs(eye).max()), 1.0)))


def _in_camera(cloud: SplatCloud, pose: DoubleArray, view: PinholeView) -> DoubleArray:
    """Positions ``(n, 3)`` in camera space."""
    matrix = view.camera_from_world @ pose
    x, y, z = np.ascontiguousarray(cloud.positions.T, np.float64)
    # written out: numpy's product of many small matrices takes ten times as long
    return np.stack([row[0] * x + row[1] * y + row[2] * z + row[3] for row in matrix[:3]], axis=1)


def _turned(axes: FloatArray, matrix: DoubleArray) -> list[FloatArray]:
    """Rows ``(n, 3)`` of the products of a matrix ``(3, 3)`` with many."""
    rows = matrix.astype(np.float32)
    return [row[0] * axes[:, 0] + row[1] * axes[:, 1] + row[2] * axes[:, 2] for row in rows]


def _is_drawn(cloud: SplatCloud, places: DoubleArray, view: PinholeView) -> BoolArray:
    """Whether each splat's centre lies between the clipping planes, and it is not too faint."""
    depth = -places[:, 2]
    drawn = (depth > view.near_m) & (depth < view.far_m) & (cloud.opacities > LEAST_OPACITY)
    for plane in view.clip_planes:
        drawn &= places @ plane[:3] + plane[3] >= 0
    return np.asarray(drawn)


def _pixels(places: DoubleArray, view: PinholeView) -> tuple[DoubleArray, DoubleArray]:
    """Pixels ``(n, 2)`` and slopes from the eye ``(n, 2)``, right and up, of points in camera space."""
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        right, up = ((places[:, i] - eye) / -places[:, 2] for i, eye in enumerate((view.eye_x_m, view.eye_y_m)))
    xx, xy, yx, yy = view.shear
    pixels = view.cx + view.fx * (xx * right + xy * up), view.cy - view.fy * (yx * right + yy * up)
    return np.stack(pixels, axis=1), np.stack([right, up], axis=1)


def _edge_slopes(view: PinholeView) -> DoubleArray:
    """Greatest slopes ``(2,)`` that the view shows, right and up."""
    x = max(abs(view.cx), abs(view.width - view.cx)) / view.fx
    y = max(abs(view.cy), abs(view.height - view.cy)) / view.fy
    return np.array([x, y])


def _decode(encoded: FloatArray) -> FloatArray:
    """Linear light of sRGB values, 0 or more (IEC 61966-2-1)."""
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4).astype(np.float32)


def _basis(towards: FloatArray, count: int) -> FloatArray:
    """Values ``(n, count)`` of the real spherical harmonics at directions ``(n, 3)`` of any length."""
    length = np.linalg.norm(towards, axis=1, keepdims=True)
    x, y, z = (towards / np.where(length > 0, length, 1)).T
    zeroth, first, second, third = _HARMONICS
    values = [np.full(len(towards), zeroth, np.float32)]
    if count > 1:
        values += [-first * y, first * z, -first * x]
    if count > 4:
        a, b, c = second
        values += [a * x * y, -a * y * z, b * (2 * z * z - x * x - y * y), -a * x * z, c * (x * x - y * y)]
    if count > 9:
        a, b, c, d, e = third
        ring = 4 * z * z - x * x - y * y
        values += [-a * y * (3 * x * x - y * y), b * x * y * z, -c * y * ring]
        values += [d * z * (2 * z * z - 3 * x * x - 3 * y * y), -c * x * ring, e * z * (x * x - y * y)]
        values += [-a * x * (x * x - 3 * y * y)]
    return np.stack(values, axis=1)
