"""Drags on the timeline: a key until the picture has changed, and the scrubber, by the pictures that follow it."""

from __future__ import annotations

from time import monotonic
from typing import TYPE_CHECKING

from render.errors import PullfocusError
from service.bench.page.controls import PAUSE_MS, centre_of, frame_width

if TYPE_CHECKING:
    from playwright.sync_api import Page

LANE_KEY = '[data-stack="point pip@44"]'
KNOT = '[data-knot="point pip@44"]'
CURVE = "point pip weight"
"""The curve that `KNOT` is a key of: its frames until the next key, 66, are those where the focus goes over."""
FARTHEST = 10
"""Frames that a key is dragged back, before it comes forth again."""
MOVES_PER_S = 30.0
FIRST_FRAME, LAST_FRAME = 1, 96
WITHIN_MS = 60_000


def key_drag_times(page: Page, handle: str, moves: int) -> list[float]:
    """Drag a key of the demo shot to and fro, frame by frame, and wait for the changed picture each time.

    Args:
        page: with the demo shot at a frame whose picture the key changes.
        handle: selector of the key.
        moves: number of moves.

    Returns:
        The times from each move of the pointer to the picture on screen, s.

    Raises:
        PullfocusError: no picture comes.
    """
    (x, y), step = centre_of(page, handle), frame_width(page)
    page.mouse.move(x, y)
    page.mouse.down()
    seconds = []
    for number in range(1, moves + 1):
        page.wait_for_timeout(PAUSE_MS)
        page.evaluate("within => pullfocusProbe.watchPicture('pointermove', within)", WITHIN_MS)
        page.mouse.move(x - step * frames_back(number), y)
        took_ms = page.evaluate("() => pullfocusProbe.result()")
        if took_ms is None:
            raise PullfocusError(f"no picture follows the key {handle}, move {number}")
        seconds.append(took_ms / 1000)
    page.keyboard.press("Escape")
    page.mouse.up()
    return seconds


def frames_back(number: int) -> int:
    """Return how far a key is dragged back after so many moves, frames: to the farthest place and forth, never twice the same."""
    step = (number - 1) % (2 * FARTHEST - 2)
    return 1 + min(step, 2 * FARTHEST - 2 - step)


def show_curve(page: Page) -> None:
    """Show the curve of `KNOT` in place of the focus curve."""
    page.get_by_role("combobox", name="Curve").select_option(CURVE)
    page.locator(KNOT).wait_for()


def scrub(page: Page, seconds: float, *, back: bool) -> list[float]:
    """Drag the scrubber from one end of the shot to the other, evenly.

    Args:
        page: with the demo shot.
        seconds: time that it takes.
        back: from the last frame to the first.

    Returns:
        The times at which pictures were painted, s since the drag began; the last one is its end.
    """
    box = page.locator(".scrub-bed").bounding_box()
    if box is None:
        raise PullfocusError("the page of the bench shows no timeline")
    y, count = box["y"] + 8, max(2, round(seconds * MOVES_PER_S))
    ends = (FIRST_FRAME, LAST_FRAME)[:: -1 if back else 1]

    def place(move: int) -> float:
        frame = ends[0] + (ends[1] - ends[0]) * move / count
        return box["x"] + box["width"] * (frame - FIRST_FRAME) / (LAST_FRAME - FIRST_FRAME)

    page.mouse.move(place(0), y)
    page.mouse.down()
    began_ms = page.evaluate("() => { pullfocusProbe.drawn.length = 0; return performance.now(); }")
    began_s = monotonic()
    for move in range(1, count + 1):
        page.wait_for_timeout(max(0.0, 1000 * (began_s + seconds * move / count - monotonic())))
        page.mouse.move(place(move), y)
    painted: list[float] = page.evaluate("() => [...pullfocusProbe.drawn.map(({ at }) => at), performance.now()]")
    page.mouse.up()
    return [(at - began_ms) / 1000 for at in painted]
