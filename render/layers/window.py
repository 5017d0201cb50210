"""Window of a picture's layers that is moved along it, and filled with strips that are peeled one by one.

A rasteriser rounds by the place of a pixel in its framebuffer, so that parts of a picture drawn with other borders differ in the
last bits of depth. Each strip is therefore always drawn with the same borders, and then copied to where the window has it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import moderngl
import numpy as np

from render.gl.compat import GL
from render.layers.peeled import Layers
from render.layers.targets import LAYERS_PER_PACK, LayerTargets, check_layer_size
from render.optics.view import PinholeView

PeelStrip = Callable[[PinholeView], Layers]
"""Peels the layers of a view, which are valid until the next call."""


class LayerWindow:
    """Part of a picture's layers.

    Args:
        ctx: context of the device.
    """

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._targets: LayerTargets | None = None
        self._held = 0, 0
        self._count, self._may_be_translucent = 0, False

    @property
    def is_held(self) -> bool:
        """Whether the window has memory on the device."""
        return self._targets is not None

    def clear(self) -> None:
        """Forget the contents, before the first window of a picture."""
        self._held = 0, 0
        self._count, self._may_be_translucent = 0, False

    def move(
        self,
        whole: PinholeView,
        axis: int,
        first: int,
        length: int,
        strip: int,
        layers: int,
        peel: PeelStrip,
        *,
        ids: bool = False,
    ) -> Layers:
        """Move the window, and fill what is new. Strips that it holds already are kept.

        Args:
            whole: view of the picture's layers.
            axis: axis along which strips follow each other: 0 for columns, 1 for rows.
            first: position of the window's first line along that axis, layer pixels; no less than before.
            length: length along that axis; it may extend beyond the picture's layers, where all is empty.
            strip: length of the strips.
            layers: at most this many layers.
            peel: peels a strip.
            ids: whether the strips hold ids.

        Returns:
            Layers of the window, valid until the next call.
        """
        size = (length, whole.height) if axis == 0 else (whole.width, length)
        targets = self._allocate(*size, layers, ids=ids)
        begin, end = self._held
        kept = max(0, end - first) if begin <= first else 0
        if kept and first > begin:
            _shift(targets, axis, first - begin, kept)
        stop = min(first + length, whole.size[axis])
        if stop < first + length:
            _clear(targets, range(len(targets.packed_w)), axis, stop - first, first + length - stop)
        at = first + kept
        while at < stop:
            strip_first = at // strip * strip
            peeled = peel(_cut(whole, axis, strip_first, strip))
            until = min(strip_first + strip, stop)
            self._copy(peeled, targets, axis, at - strip_first, at - first, until - at)
            at = until
        self._held = first, stop
        self._ctx.memory_barrier()
        view = _cut(whole, axis, first, length)
        return Layers(view, targets, self._count, self._may_be_translucent, within=whole)

    def _copy(self, peeled: Layers, targets: LayerTargets, axis: int, source: int, target: int, length: int) -> None:
        """Copy lines of a strip into the window."""
        self._count = max(self._count, peeled.count)
        self._may_be_translucent = self._may_be_translucent or peeled.may_be_translucent
        packs = max(1, -(-peeled.count // LAYERS_PER_PACK))
        copy_lines(peeled.targets, targets, axis, source, target, length, packs, peeled.count)
        _clear(targets, range(packs, len(targets.packed_w)), axis, target, length)

    def _allocate(self, width: int, height: int, layers: int, *, ids: bool) -> LayerTargets:
        targets = self._targets
        if targets is None or not targets.fits(width, height, layers, ids=ids):
            check_layer_size(self._ctx, width, height)
            self.release()
            targets = self._targets = LayerTargets.allocate(self._ctx, width, height, layers, ids=ids)
        return targets

    def release(self) -> None:
        """Release the memory."""
        if self._targets is not None:
            self._targets.release()
            self._targets = None
        self.clear()


def copy_lines(
    source: LayerTargets, target: LayerTargets, axis: int, begin: int, to: int, length: int, packs: int, layers: int
) -> None:
    """Copy columns (axis 0) or rows (axis 1) of so many layers, in so many packs, from one set of textures to another or,
    without overlap, within one."""
    pairs: list[tuple[moderngl.Texture, moderngl.Texture]] = [
        *zip(source.packed_w[:packs], target.packed_w[:packs], strict=True),
        *zip(source.packed_slopes[:packs], target.packed_slopes[:packs], strict=True),
        (source.background, target.background),
    ]
    width, height = (length, target.height) if axis == 0 else (target.width, length)
    x, y, to_x, to_y = (begin, 0, to, 0) if axis == 0 else (0, begin, 0, to)

    def copy(kind: int, one: int, other: int, depth: int) -> None:
        GL.glCopyImageSubData(one, kind, 0, x, y, 0, other, kind, 0, to_x, to_y, 0, width, height, depth)

    for one, other in pairs:
        copy(GL.GL_TEXTURE_2D, one.glo, other.glo, 1)
    if layers:
        copy(GL.GL_TEXTURE_2D_ARRAY, source.radiance.glo, target.radiance.glo, layers)
    if layers and source.ids is not None and target.ids is not None:
        copy(GL.GL_TEXTURE_2D_ARRAY, source.ids.glo, target.ids.glo, layers)


def _shift(targets: LayerTargets, axis: int, by: int, length: int) -> None:
    """Move lines toward the first line of the textures, no more at once than they move: a copy must not overlap itself."""
    for at in range(0, length, by):
        some = min(by, length - at)
        copy_lines(targets, targets, axis, at + by, at, some, len(targets.packed_w), len(targets.slots))


def _clear(targets: LayerTargets, packs: range, axis: int, at: int, length: int) -> None:
    """Empty lines of some packs of layers."""
    x, y = (at, 0) if axis == 0 else (0, at)
    width, height = (length, targets.height) if axis == 0 else (targets.width, length)
    for pack in packs:
        texture = targets.packed_w[pack]
        GL.glClearTexSubImage(
            texture.glo, 0, x, y, 0, width, height, 1, GL.GL_RGBA, GL.GL_FLOAT, np.zeros(4, np.float32)
        )


def _cut(whole: PinholeView, axis: int, first: int, length: int) -> PinholeView:
    """View of some columns or rows."""
    if axis == 0:
        return replace(whole, width=length, cx=whole.cx - first)
    return replace(whole, height=length, cy=whole.cy - first)
