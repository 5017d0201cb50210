"""Sketches that are kept: layers of small previews of many views, for a crowd of viewers who each look at one."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass

from render.layers.peeled import Layers
from render.optics.view import PinholeView

MAX_BYTES = 256 << 20
"""Memory of the sketches that are kept: some sixty of 480 px."""


@dataclass(frozen=True)
class SketchKey:
    """Scene and size of a sketch: all that it shows, but for the view's place and angle.

    Attributes:
        scene: version of the scene (`render.model.scene.Scene.version`).
        camera_path: prim path of the camera, which may see what others do not.
        size: width and height of the picture without its margin, pixels.
        unlit: whether base colour was taken for radiance.
    """

    scene: Hashable
    camera_path: str
    size: tuple[int, int]
    unlit: bool


class Sketches:
    """Kept sketches; those that were not used for longest are released where all of them take too much memory.

    Args:
        max_bytes: memory that they may take on the device.
    """

    def __init__(self, max_bytes: int = MAX_BYTES) -> None:
        self._max_bytes = max_bytes
        self._kept: OrderedDict[SketchKey, Layers] = OrderedDict()

    def find(self, key: SketchKey, view: PinholeView) -> Layers | None:
        """Return the kept sketch of a view, or None. Its shadows are those of the focus for which it was drawn.

        Args:
            key: what it shows.
            view: of its layers.
        """
        kept = self._kept.get(key)
        if kept is None or not kept.view.matches(view):
            return None
        self._kept.move_to_end(key)
        return kept

    def keep(self, key: SketchKey, layers: Layers) -> None:
        """Keep a sketch, whose memory is released in time.

        Args:
            key: what it shows.
            layers: its layers, which the peeler has handed over.
        """
        self._release(key)
        self._kept[key] = layers
        while len(self._kept) > 1 and sum(each.targets.bytes for each in self._kept.values()) > self._max_bytes:
            self._release(next(iter(self._kept)))

    def release(self) -> None:
        """Release all of them."""
        for key in list(self._kept):
            self._release(key)

    def _release(self, key: SketchKey) -> None:
        layers = self._kept.pop(key, None)
        if layers is not None:
            layers.targets.release()
