"""Stand-ins of models by their draw modes (UsdGeomModelAPI): bars along axes or the edges of a box, and textured cards.

Hydra draws axes and boxes as lines one pixel wide. Here they are bars, which a lens can blur and a light can light.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from pxr import Usd, UsdGeom

from render.model.arrays import DoubleArray, FloatArray, IntArray
from render.stage.geometry.polygons import BadGeometry, Polygons
from render.stage.geometry.splat_boxes import box_below
from render.stage.values import UNREADABLE, why_unreadable

MODES = ("origin", "bounds", "cards")
"""Draw modes that replace a model."""
COLOR = "model:drawModeColor"
TEXTURES = {
    "XPos": "model:cardTextureXPos",
    "YPos": "model:cardTextureYPos",
    "ZPos": "model:cardTextureZPos",
    "XNeg": "model:cardTextureXNeg",
    "YNeg": "model:cardTextureYNeg",
    "ZNeg": "model:cardTextureZNeg",
}
"""Attributes of the textures of cards by side; three on is the other side of the same axis."""
AXIS_WIDTH = 1 / 60
"""Width of the axes of an origin, which are one unit long."""
EDGE_WIDTH = 1 / 300
"""Width of the edges of a box, of the box's diagonal."""
_PURPOSES = (UsdGeom.Tokens.default_, UsdGeom.Tokens.proxy, UsdGeom.Tokens.render)
_QUAD = np.array([[1, 1], [0, 1], [0, 0], [1, 0]], np.float64)  # a card's corners, across and up
_FACES_OF_BAR = np.array(
    [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
)  # corners of a box are numbered 4x + 2y + z


@dataclass(frozen=True)
class Card:
    """One card.

    Attributes:
        side: one of `TEXTURES`'s.
        look: name of the attribute that it takes its look from: the texture of a side, or `COLOR`.
        flipped: whether the texture is that of the other side.
        model_from_clip: of a card that its texture places: its rows take ``(x, y, z, 1)`` to the model, as USD's matrices do.
    """

    side: str
    look: str
    flipped: bool = False
    model_from_clip: tuple[tuple[float, ...], ...] | None = None


@dataclass(frozen=True)
class StandIn:
    """Stand-in of a model.

    Attributes:
        mode: one of `MODES`.
        cards: the cards.
        crossed: whether cards stand in the middle of the model's box rather than on its faces.
    """

    mode: str
    cards: tuple[Card, ...] = ()
    crossed: bool = False

    @property
    def looks(self) -> tuple[str, ...]:
        """Attributes that parts of it take their looks from."""
        return tuple(dict.fromkeys(card.look for card in self.cards)) if self.mode == "cards" else (COLOR,)

    def part_of_faces(self) -> IntArray:
        """``(f,)`` which of ``looks`` each face has."""
        looks = self.looks
        return np.array([looks.index(card.look) for card in self.cards], np.int32)


def stand_in_polygons(stand_in: StandIn, prim: Usd.Prim, time: Usd.TimeCode) -> Polygons:
    """The polygons of a stand-in at a time, in the model's own space and units; of cards at the earliest time, as UsdGeom has it.

    Raises:
        BadGeometry: the model has no extent.
    """
    match stand_in.mode:
        case "origin":
            return _bars(np.zeros((3, 3)), np.eye(3), AXIS_WIDTH)
        case "bounds":
            low, high = model_box(prim, time)
            ends = np.array(list(_edges())) * (high - low) + low
            return _bars(ends[:, 0], ends[:, 1], EDGE_WIDTH * float(np.linalg.norm(high - low)))
    if all(card.model_from_clip for card in stand_in.cards):
        corners = [_placed_card(card) for card in stand_in.cards]
    else:
        low, high = model_box(prim, Usd.TimeCode.EarliestTime())
        corners = [_unit_card(card.side, crossed=stand_in.crossed) * (high - low) + low for card in stand_in.cards]
    return _quads(np.concatenate([np.zeros((0, 3)), *corners]))


def card_coordinates(stand_in: StandIn) -> FloatArray:
    """``(4n, 2)`` texture coordinates of the corners of cards: upright and not mirrored, seen from where a card's side is.

    A card that has only the other side's texture shows it as through glass.
    """
    every = [np.zeros((0, 2))]
    for card in stand_in.cards:
        mirrored = np.array([card.flipped, False])
        if card.side.startswith("Z") and card.model_from_clip is None:
            turned = card.side == "ZNeg"
            mirrored = np.array([turned, turned != card.flipped])
        every.append(np.where(mirrored, 1 - _QUAD, _QUAD))
    return np.concatenate(every).astype(np.float32)


def stand_in_varies(stand_in: StandIn, prim: Usd.Prim) -> bool:
    """Whether the box that a stand-in shows may change over time."""
    if stand_in.mode != "bounds":
        return False
    hint = UsdGeom.ModelAPI(prim).GetExtentsHintAttr()
    if hint and hint.HasAuthoredValue():
        return bool(hint.ValueMightBeTimeVarying())
    below = iter(Usd.PrimRange(prim, Usd.TraverseInstanceProxies()))
    next(below)  # where the model stands itself does not matter
    return any(attribute.ValueMightBeTimeVarying() for each in below for attribute in each.GetAuthoredAttributes())


def model_box(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[DoubleArray, DoubleArray]:
    """Least and greatest corner ``(3,)`` of a model in its own space, of all that is of purpose default, proxy or render.

    Raises:
        BadGeometry: there is nothing.
    """
    try:
        box = box_below(prim, time, _PURPOSES)
    except UNREADABLE as problem:
        raise BadGeometry(why_unreadable(problem)) from problem
    low, high = np.array(box.GetMin(), np.float64), np.array(box.GetMax(), np.float64)
    if box.IsEmpty() or not np.isfinite([low, high]).all() or not (high > low).any():
        raise BadGeometry("its draw mode needs an extent, and it has none")
    return low, high


def _edges() -> Iterator[tuple[tuple[float, ...], tuple[float, ...]]]:
    """The edges of the unit box."""
    for one, other in product(product((0.0, 1.0), repeat=3), repeat=2):
        if (
            sum(b - a for a, b in zip(one, other, strict=True))
            == sum(a != b for a, b in zip(one, other, strict=True))
            == 1
        ):
            yield one, other


def _bars(starts: DoubleArray, ends: DoubleArray, width: float) -> Polygons:
    """Boxes around lines ``(n, 3)`` along axes, which stand out of them by half the width on all sides."""
    boxes = np.stack([np.minimum(starts, ends) - width / 2, np.maximum(starts, ends) + width / 2], axis=1)
    corners = np.stack([boxes[:, [x, y, z], [0, 1, 2]] for x, y, z in product((0, 1), repeat=3)], axis=1)
    return _quads(corners[:, _FACES_OF_BAR].reshape(-1, 3))


def _quads(corners: DoubleArray) -> Polygons:
    count = len(corners)
    return Polygons(
        points=corners.astype(np.float32),
        counts=np.full(count // 4, 4, np.int32),
        corners=np.arange(count, dtype=np.int32),
    )


def _unit_card(side: str, *, crossed: bool) -> DoubleArray:
    """``(4, 3)`` corners of a card in the unit box, counter-clockwise seen from its side (UsdImaging's draw mode stand-in)."""
    axis = "XYZ".index(side[0])
    across, up = _QUAD.T
    out = np.full(4, 0.5 if crossed else 1.0)
    corners = np.stack([[out, across, up], [1 - across, out, up], [across, up, out]][axis], axis=1)
    return corners if side.endswith("Pos") else 1 - corners[::-1]


def _placed_card(card: Card) -> DoubleArray:
    """``(4, 3)`` corners of a card that covers clip space from -1 to 1, whose Y points down as a texture's rows do."""
    clip = np.concatenate([2 * _QUAD - 1, np.tile([0.0, 1.0], (4, 1))], axis=1) * [1, -1, 1, 1]
    corners = clip @ np.array(card.model_from_clip)
    if not (np.abs(corners[:, 3]) > np.finfo(np.float64).tiny).all():
        raise BadGeometry(f"the worldtoscreen of its texture {card.look} puts its card at infinity")
    return np.asarray(corners[:, :3] / corners[:, 3:])
