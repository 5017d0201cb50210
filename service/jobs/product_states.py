"""States of the products of renders, such as movies: what is to be made of a render once its frames are stored.

A product of *pictures* is made of stored frames, so that it waits for all of them. It has failed, without an attempt, where a
frame has failed; it is made of the others once these are accepted. The others, such as reports, need the shot alone, and are
made beside the frames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import cast

from sqlalchemy import ColumnElement

from service.jobs.turns import MOST_PAUSE_S
from service.models.render_products import needs_pictures
from service.storage.database.tables import ProductEntry, RenderRow

NEW: ProductEntry = {
    "state": "waiting",
    "attempts": 0,
    "failures": 0,
    "losses": 0,
    "not_before": 0.0,
    "holder": None,
    "lease_until": None,
    "size_bytes": None,
    "error": None,
    "reason": None,
}
"""A product that waits."""
NO_FRAMES = "Frames have failed or were given up: retry the render, or accept it to have this made of the others."


def add_products(render: RenderRow, names: Iterable[str]) -> None:
    """Give a new render its products."""
    put_products(render, dict.fromkeys(names, NEW))


def put_products(render: RenderRow, changed: dict[str, ProductEntry]) -> None:
    """Change products of a render, and count all in their states."""
    render.products = {**(render.products or {}), **changed}
    states = [entry["state"] for entry in render.products.values()]
    waiting = [name for name, entry in render.products.items() if entry["state"] == "waiting"]
    render.products_unpictured = sum(not needs_pictures(name) for name in waiting)
    render.products_waiting, render.products_running = states.count("waiting"), states.count("running")
    render.products_lacking = states.count("failed") + states.count("canceled")


def may_be_made(render: RenderRow, name: str, now: float) -> bool:
    """Return whether a product waits and may be made now, as far as the frames and its own pause go."""
    entry = render.products[name]
    if entry["state"] != "waiting" or now < entry["not_before"] <= now + MOST_PAUSE_S:
        return False  # a pause that ends much later was begun before the clock was set back
    return not needs_pictures(name) or render.ready + render.running == 0


def has_product_to_make() -> ColumnElement[bool]:
    """Return the condition that a render has a product which waits and may be made, as far as the frames go."""
    needs_no_frame = (RenderRow.products_unpictured > 0) | (RenderRow.ready + RenderRow.running == 0)
    return (RenderRow.products_waiting > 0) & needs_no_frame


def settle_products(render: RenderRow) -> None:
    """Let the products fail that wait for frames which have failed; called when frames have ended."""
    if render.ready + render.running == 0 and render.failed + render.canceled > 0 and not render.accepted:
        _change(render, {"state": "failed", "error": NO_FRAMES, "reason": "frames"}, _waits_for_frames)


def cancel_products(render: RenderRow) -> None:
    """Give up the products that wait."""
    _change(render, {"state": "canceled"}, lambda _, entry: entry["state"] == "waiting")


def retry_products(render: RenderRow, *, has_new_frames: bool) -> None:
    """Have the products made again that were not; and those of pictures, where frames are drawn again.

    One of these that is made meanwhile is made of the frames of before, so that the attempt at it is void.
    """

    def is_wanted(name: str, entry: ProductEntry) -> bool:
        return entry["state"] in ("failed", "canceled") or (
            has_new_frames and entry["state"] in ("done", "running") and needs_pictures(name)
        )

    anew = {name: value for name, value in NEW.items() if name != "attempts"}
    _change(render, anew, is_wanted)


def accept_products(render: RenderRow) -> None:
    """Have those products made of the other frames that only waited for frames which have failed."""
    _change(render, {"state": "waiting", "error": None, "reason": None}, lambda _, entry: entry["reason"] == "frames")


def _waits_for_frames(name: str, entry: ProductEntry) -> bool:
    return entry["state"] == "waiting" and needs_pictures(name)


def _change(render: RenderRow, change: dict[str, object], is_meant: Callable[[str, ProductEntry], bool]) -> None:
    """Change those products of a render that are meant."""
    changed = {name: changed_entry(entry, change) for name, entry in render.products.items() if is_meant(name, entry)}
    if changed:
        put_products(render, changed)


def changed_entry(entry: ProductEntry, change: dict[str, object]) -> ProductEntry:
    """Return an entry with other values of some fields."""
    return cast(ProductEntry, {**entry, **change})
