"""Strikes of the chaos bench, and their order."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Literal, get_args

Strike = Literal[
    "kill worker", "kill scheduler", "kill service", "kill database", "fill disk", "clock forward", "clock back"
]
KINDS: tuple[Strike, ...] = get_args(Strike)
JUMP_S = 3600
"""Time by which a clock jumps, s."""


def order_of(kinds: Sequence[Strike], count: int, seed: int) -> list[Strike]:
    """Return a random order of strikes in which each kind comes as often as the others, give or take one.

    Args:
        kinds: those that can be done here.
        count: number of strikes.
        seed: of the order.
    """
    chance = random.Random(seed)
    order: list[Strike] = []
    while len(order) < count:
        order += chance.sample(kinds, len(kinds))
    return order[:count]
