"""Ghost pass: sheets of light over a picture, each clipped by the iris and the rims that it passed.

Sheets larger than some pixels are drawn as triangles on the device; small ones, which come to a focus on the film,
would fall between its pixels and are added to the nearest ones on the CPU.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from render.errors import GraphicsError
from render.gl.resources import Resources
from render.gl.shaders import load_source
from render.model.arrays import DoubleArray, FloatArray
from render.optics.flare.ghost_sheets import CROSSINGS, GhostSheets, mesh_areas
from render.optics.view import PinholeView

_ATTRIBUTES = ("place", "first_stop", "second_stop", "third_stop", "near_rim", "light")
_LAYOUT = "2f 2f 2f 2f 1f 3f"
_IRIS_UNIT = 0
_SMALL_PX = 600.0  # area of a sheet of some thousand points; a smaller one has several points in each pixel


class GhostPass:
    """Draws ghosts in one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        """Compile the shaders. Raises `GraphicsError` where the driver refuses them."""
        self._ctx = ctx
        try:
            self._program = ctx.program(load_source("lens/ghost.vert"), load_source("lens/ghost.frag"))
        except moderngl.Error as error:
            raise GraphicsError(f"the shaders of ghosts did not compile: {error}") from error

    def draw(self, sheets: Iterable[GhostSheets], view: PinholeView, iris: DoubleArray) -> FloatArray:
        """Draw the light of ghosts.

        Args:
            sheets: sheets to draw, consumed one by one.
            view: view of the picture, through the middle of the pupil.
            iris: ``(side, side)`` transmission over the square around the unit circle, row 0 at the top.

        Returns:
            ``(height, width, 3)`` radiance.

        Raises:
            GraphicsError: the device is out of memory.
        """
        try:
            return self._draw_meshes(sheets, view, iris)
        except moderngl.Error as error:
            raise GraphicsError(f"ghosts could not be drawn: {error}") from error

    def _draw_meshes(self, sheets: Iterable[GhostSheets], view: PinholeView, iris: DoubleArray) -> FloatArray:
        spread = np.zeros((view.height, view.width, 3))
        with Resources() as scope:
            canvas = scope.keep(self._ctx.texture((view.width, view.height), 4, dtype="f4"))
            target = scope.keep(self._ctx.framebuffer(color_attachments=[canvas]))
            scope.callback(self._stop_drawing, self._ctx.detect_framebuffer())
            self._begin(target, scope.keep(_iris_texture(self._ctx, iris)), view)
            for some in sheets:
                positions = _pixels(some.slopes, view)
                is_small = (mesh_areas(positions) * some.whole).sum(axis=(1, 2)) < _SMALL_PX
                self._draw(some, positions, ~is_small)
                _spread(spread, some, positions, is_small, iris, view)
            drawn = np.frombuffer(canvas.read(), np.float32).reshape(view.height, view.width, 4)
        return np.asarray(drawn[..., :3] + spread, np.float32)

    def release(self) -> None:
        """Release the memory on the device."""
        self._program.release()

    def _begin(self, target: moderngl.Framebuffer, iris: moderngl.Texture, view: PinholeView) -> None:
        target.use()
        target.viewport = (0, 0, view.width, view.height)
        target.clear(0.0, 0.0, 0.0, 0.0)
        self._ctx.enable_only(moderngl.BLEND)
        self._ctx.blend_func = moderngl.ONE, moderngl.ONE
        iris.use(_IRIS_UNIT)
        self._program["inner"] = (iris.width - 2) / iris.width
        self._program["iris"] = _IRIS_UNIT
        self._program["picture"] = (view.width, view.height)

    def _stop_drawing(self, before: moderngl.Framebuffer) -> None:
        self._ctx.enable_only(moderngl.NOTHING)
        before.use()

    def _draw(self, sheets: GhostSheets, positions: DoubleArray, which: NDArray[np.bool_]) -> None:
        if not sheets.whole[which].any():
            return
        corners = _vertices(sheets, positions)[which]
        triangles = _triangles(sheets.whole[which], corners.shape[1:3])
        with Resources() as scope:
            vertices = scope.keep(self._ctx.buffer(np.ascontiguousarray(corners, np.float32).tobytes()))
            indices = scope.keep(self._ctx.buffer(triangles.tobytes()))
            layout = (vertices, _LAYOUT, *_ATTRIBUTES)
            scope.keep(self._ctx.vertex_array(self._program, [layout], indices)).render(moderngl.TRIANGLES)


def _pixels(slopes: DoubleArray, view: PinholeView) -> DoubleArray:
    return np.asarray(slopes * [view.fx, -view.fy] + [view.cx, view.cy])


def _iris_texture(ctx: moderngl.Context, iris: DoubleArray) -> moderngl.Texture:
    """Upload the iris with a dark edge, which is repeated outside."""
    padded = np.pad(iris, 1).astype(np.float32)
    texture = ctx.texture(padded.shape[::-1], 1, padded.tobytes(), dtype="f4")
    texture.filter = moderngl.LINEAR, moderngl.LINEAR
    texture.repeat_x = texture.repeat_y = False
    return texture


def _vertices(sheets: GhostSheets, positions: DoubleArray) -> DoubleArray:
    """Vertices ``(m, rows, columns, 12)`` in the order of the layout."""
    stops = sheets.stops.reshape(*positions.shape[:3], 2 * CROSSINGS)
    return np.concatenate([positions, stops, sheets.rim[..., None], sheets.radiance], axis=-1)


def _triangles(whole: NDArray[np.bool_], shape: tuple[int, ...]) -> NDArray[np.uint32]:
    """Corners ``(n, 3)`` of the triangles of all whole meshes."""
    rows, columns = shape
    sheet, row, column = np.nonzero(whole)
    at = (sheet * rows + row) * columns + column
    first, last = np.stack([at, at + 1, at + columns], 1), np.stack([at + 1, at + columns + 1, at + columns], 1)
    return np.concatenate([first, last]).astype(np.uint32)


def _spread(
    total: DoubleArray,
    sheets: GhostSheets,
    positions: DoubleArray,
    which: NDArray[np.bool_],
    iris: DoubleArray,
    view: PinholeView,
) -> None:
    """Add small sheets to a picture: the light of each mesh, at its middle, is shared by the four nearest pixels."""
    if not which.any():
        return
    area = mesh_areas(positions[which]) * sheets.whole[which]
    middle = _middles(positions[which])
    passed = (_middles(sheets.rim[which]) <= 1).astype(np.float64)
    for k in range(CROSSINGS):
        passed *= _through(iris, _middles(sheets.stops[which][..., k, :]))
    light = _middles(sheets.radiance[which]) * (area * passed)[..., None]
    is_lit = (area * passed > 0) & np.isfinite(middle).all(axis=-1)
    at, light = middle[is_lit] - 0.5, light[is_lit]
    corner = np.floor(at)
    share = at - corner
    for right in (0, 1):
        for down in (0, 1):
            column, row = (corner + np.array([right, down])).T
            weight = np.abs(1 - right - share[:, 0]) * np.abs(1 - down - share[:, 1])
            inside = (column >= 0) & (column < view.width) & (row >= 0) & (row < view.height)
            place = row[inside].astype(np.int64), column[inside].astype(np.int64)
            np.add.at(total, place, light[inside] * weight[inside, None])


def _middles(values: NDArray[Any]) -> DoubleArray:
    with np.errstate(invalid="ignore"):
        return np.asarray((values[:, :-1, :-1] + values[:, :-1, 1:] + values[:, 1:, :-1] + values[:, 1:, 1:]) / 4)


def _through(iris: DoubleArray, stops: DoubleArray) -> DoubleArray:
    """Transmission of the iris at points in units of its radius; 0 outside."""
    side = len(iris)
    with np.errstate(invalid="ignore"):
        column = np.floor((stops[..., 0] + 1) / 2 * side)
        row = np.floor((1 - stops[..., 1]) / 2 * side)
        inside = (column >= 0) & (column < side) & (row >= 0) & (row < side)
    place = np.where(inside, row, 0).astype(np.int64), np.where(inside, column, 0).astype(np.int64)
    return np.where(inside, iris[place], 0.0)
