"""Response of the page's controls: from an input to the frame that shows the control's new state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.errors import PullfocusError
from service.bench.page.browser import wait_settled

if TYPE_CHECKING:
    from playwright.sync_api import Page

FRAME = 55
"""Frame of the demo shot at which both of its points are in the picture and the focus is on its way between them."""
PAUSE_MS, WITHIN_MS = 200, 30_000
"""Time before an input; and after which an input is said to have had no effect."""

Act = Callable[["Page", int], None]
"""Does something on a page, for the n-th time from 0 on."""


def _nothing(_page: Page, _number: int) -> None:
    """Do nothing."""


@dataclass(frozen=True)
class Control:
    """A control, an input to it, and its state.

    Attributes:
        name: of the control and the input.
        event: kind of the event that the input begins with.
        selector: of the elements that show its state.
        read: property or attribute of them that does.
        act: the input.
        prepare: what is done before, and is not measured.
        begin: done once, before all inputs.
        end: done once, after all inputs.
        is_held: whether the inputs are moves of a drag, beside the live pictures of those before. Others come at rest: the one
            before is saved, and its best picture is on screen.
    """

    name: str
    event: str
    selector: str
    read: str
    act: Act
    prepare: Act = _nothing
    begin: Act = _nothing
    end: Act = _nothing
    is_held: bool = False


def response_times(page: Page, control: Control, repeats: int) -> list[float]:
    """Measure a control.

    Args:
        page: with the demo shot at `FRAME`.
        control: to be measured.
        repeats: number of inputs.

    Returns:
        The times from each input to its effect on screen, s.

    Raises:
        PullfocusError: an input has no effect.
    """
    seconds = []
    wait_settled(page)
    control.begin(page, 0)
    for number in range(repeats):
        if not control.is_held:
            wait_settled(page)
        page.wait_for_timeout(PAUSE_MS)
        control.prepare(page, number)
        page.evaluate(
            "([event, selector, read, within]) => pullfocusProbe.watchState(event, selector, read, within)",
            [control.event, control.selector, control.read, WITHIN_MS],
        )
        control.act(page, number)
        took_ms = page.evaluate("() => pullfocusProbe.result()")
        if took_ms is None:
            raise PullfocusError(
                f"the page of the bench shows no effect of the input: {control.name}, time {number + 1}"
            )
        seconds.append(took_ms / 1000)
    control.end(page, repeats)
    return seconds


def centre_of(page: Page, selector: str) -> tuple[float, float]:
    """Return the centre of an element, CSS pixels. Raises `PullfocusError` where it is not on screen."""
    element = page.locator(selector).first
    element.evaluate("element => element.scrollIntoView({ block: 'center' })")  # not below what stays at an edge
    box = element.bounding_box()
    if box is None:
        raise PullfocusError(f"the page of the bench does not show {selector}")
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def frame_width(page: Page) -> float:
    """Return the width of a frame of the timeline, CSS pixels."""
    box = page.locator(".scrub-bed").bounding_box()
    if box is None:
        raise PullfocusError("the page of the bench shows no timeline")
    return box["width"] / 95


def key(name: str) -> Act:
    """Make the press of a key."""
    return lambda page, _: page.keyboard.press(name)


def key_of(*names: str) -> Act:
    """Make the press of one key after the other, in turn."""
    return lambda page, number: page.keyboard.press(names[number % len(names)])


def _typed(selector: str, *texts: str) -> Act:
    return lambda page, number: page.locator(selector).first.fill(texts[number % len(texts)])


def _click(page: Page, _number: int) -> None:
    page.mouse.down()
    page.mouse.up()


def _over(*selectors: str) -> Act:
    return lambda page, number: page.mouse.move(*centre_of(page, selectors[number % len(selectors)]))


def _grabbed(selector: str) -> Act:
    def grab(page: Page, _number: int) -> None:
        x, y = centre_of(page, selector)
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x + 10, y)

    return grab


def _moved(selector: str, px: float = 0.0) -> Act:
    """Move what is held to the right and back; by a width of a frame where no other is given."""

    def move(page: Page, number: int) -> None:
        x, y = centre_of(page, selector)
        page.mouse.move(x + (1 if number % 2 else -1) * (px or frame_width(page)), y)

    return move


def _let_go(page: Page, _number: int) -> None:
    page.keyboard.press("Escape")
    page.mouse.up()
    page.keyboard.press("Escape")


def _hide_sharpness(page: Page, pressed: int) -> None:
    for _ in range(-pressed % LOOKS):
        page.keyboard.press("p")


def _focused(selector: str) -> Act:
    return lambda page, _: page.locator(selector).focus()


def _left(page: Page, _number: int) -> None:
    page.evaluate("() => document.activeElement?.blur()")


def _dragged(name: str, selector: str, shown: tuple[str, str], px: float = 0.0) -> Control:
    moved = _moved(selector, px)
    return Control(name, "pointermove", *shown, act=moved, begin=_grabbed(selector), end=_let_go, is_held=True)


LOOKS = 3
"""Presses of P after which the sharpness is shown as before."""
_STOP = 'input.number[aria-label="f-number"]'
_STOP_SLIDER = 'input.slider[aria-label="f-number"]'
_DISTANCE = 'input.number[aria-label="Focus distance"]'
_DISTANCE_SLIDER = 'input.slider[aria-label="Focus distance"]'
_FRAME = '.transport input[aria-label="Frame"]'
_MODE = '[aria-label="Who focuses"] [role="radio"]'
_ENABLED = '[aria-label="pip enabled"]'
_DIAMOND = '[aria-label="Key of f-number"]'
_LANE_KEY = '[data-stack="point pip@44"]'
_TIME = (".scrubber", "aria-valuenow")
_PLAYBACK = 'button[aria-controls="playback"]'

CONTROLS: tuple[Control, ...] = (
    Control(
        "focus mode clicked",
        "pointerup",
        _MODE,
        "aria-checked",
        _click,
        prepare=_over(f"{_MODE}:nth-of-type(1)", f"{_MODE}:nth-of-type(2)"),
        end=_left,
    ),
    Control("f-number typed", "keydown", _STOP, "value", key("Enter"), prepare=_typed(_STOP, "2", "4")),
    Control("frame typed", "keydown", *_TIME, act=key("Enter"), prepare=_typed(_FRAME, "54", "55")),
    _dragged("slider dragged", _STOP_SLIDER, (_STOP, "value"), px=20),
    Control(
        "slider stepped by a key",
        "keydown",
        _DISTANCE,
        "value",
        key_of("ArrowRight", "ArrowLeft"),
        begin=_focused(_DISTANCE_SLIDER),
        end=_left,
    ),
    Control("point switched off and on", "pointerup", _ENABLED, "checked", _click, prepare=_over(_ENABLED), end=_left),
    Control("key set and removed", "pointerup", _DIAMOND, "aria-pressed", _click, prepare=_over(_DIAMOND), end=_left),
    Control("menu opened and closed", "pointerup", _PLAYBACK, "aria-expanded", _click, prepare=_over(_PLAYBACK)),
    Control("panel switched, C", "keydown", '[role="tab"]', "aria-selected", key("c")),
    Control("next point, ]", "keydown", ".marker", "aria-pressed", key("]")),
    Control("previous point, [", "keydown", ".marker", "aria-pressed", key("[")),
    Control("markers hidden and shown, M", "keydown", ".marker", "class", key("m")),
    Control("sharpness shown, P", "keydown", ".picture canvas.sharpness", "data-look", key("p"), end=_hide_sharpness),
    Control("frame stepped, arrow", "keydown", *_TIME, act=key_of("ArrowLeft", "ArrowRight")),
    _dragged("scrubber dragged", ".scrub-head", _TIME),
    _dragged("marker dragged", ".marker", (".marker", "style"), px=12),
    _dragged("key dragged", _LANE_KEY, (_LANE_KEY, "style")),
)
