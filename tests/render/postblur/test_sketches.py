"""Sketches that are kept for many viewers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import cast

import numpy as np

from render.layers.peeled import Layers
from render.layers.targets import LayerTargets
from render.optics.view import PinholeView
from render.postblur.sketches import Sketches, SketchKey

VIEW = PinholeView(160, 90, 100.0, 100.0, 80.0, 45.0, 0.1, 100.0, np.eye(4))
KEY = SketchKey("scene", "/cam", (160, 90), False)


@dataclass
class Textures:
    """Textures of so many bytes."""

    bytes: int = 10
    released: list[bool] = field(default_factory=list)

    def release(self) -> None:
        self.released.append(True)


def sketch() -> tuple[Layers, Textures]:
    textures = Textures()
    return Layers(VIEW, cast("LayerTargets", textures), 1), textures


def test_what_was_not_used_for_longest_is_released() -> None:
    sketches = Sketches(max_bytes=20)
    first, second, third = (replace(KEY, scene=name) for name in ("first", "second", "third"))
    made = {key: sketch() for key in (first, second, third)}
    for key in (first, second):
        sketches.keep(key, made[key][0])
    assert sketches.find(first, VIEW) is made[first][0]
    sketches.keep(third, made[third][0])
    assert sketches.find(second, VIEW) is None
    assert [textures.released for _, textures in made.values()] == [[], [True], []]


def test_another_view_replaces_the_one_that_is_kept() -> None:
    sketches = Sketches()
    layers, textures = sketch()
    sketches.keep(KEY, layers)
    assert sketches.find(KEY, replace(VIEW, cx=81.0)) is None
    sketches.keep(KEY, replace(sketch()[0], view=replace(VIEW, cx=81.0)))
    assert sketches.find(KEY, VIEW) is None
    assert textures.released == [True]


def test_a_sketch_larger_than_the_limit_is_kept_alone() -> None:
    sketches = Sketches(max_bytes=1)
    for name in ("first", "second"):
        sketches.keep(replace(KEY, scene=name), sketch()[0])
    assert sketches.find(replace(KEY, scene="first"), VIEW) is None
    assert sketches.find(replace(KEY, scene="second"), VIEW) is not None
    sketches.release()
    assert sketches.find(replace(KEY, scene="second"), VIEW) is None
