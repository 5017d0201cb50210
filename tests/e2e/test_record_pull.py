"""A pull is recorded on the focus ring by hand, keys, MIDI and a game controller, and becomes few keys of the shot."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from playwright.sync_api import Locator, Page, ViewportSize, expect

from tests.e2e.axe import violations
from tests.e2e.editor import tab_to, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

TOLERANCE, MOST_KEYS = 0.02, 8
WIDE: ViewportSize = {"width": 1280, "height": 720}
PHONE: ViewportSize = {"width": 390, "height": 844}
HAND = """(turn) => {
  const [first, frames, framesPerMs] = [8, 60, 24 * 0.25 / 1000];
  const frame = () => Number(document.querySelector(".scrubber").getAttribute("aria-valuenow"));
  let [begun, before] = [null, 0];
  const follow = (ms) => {
    if (begun === null && frame() >= first) begun = ms;
    const passed = begun === null ? 0 : Math.min((ms - begun) * framesPerMs, frames);
    if (passed > before) turn(passed, before);
    before = passed;
    if (passed < frames && !document.querySelector(".outcome")) requestAnimationFrame(follow);
  };
  requestAnimationFrame(follow);
}"""
"""Turns the ring by the clock, as a steady hand does, by a function of the frames since it began, and until the last turn."""
SPEED = "0.25"
"""Speed at which the shot plays meanwhile: a busy machine keeps up."""
DEVICES = """() => {
  const port = { name: "Wheel", onmidimessage: null };
  const access = { inputs: new Map([["1", port]]), onstatechange: null };
  const set = (name, value) => Object.defineProperty(navigator, name, { value, configurable: true });
  window.asked = 0;
  set("requestMIDIAccess", () => { window.asked += 1; return Promise.resolve(access); });
  window.sendMidi = (...bytes) => port.onmidimessage?.({ data: Uint8Array.from(bytes) });
  window.pad = { axes: [0, -1], buttons: [] };
  set("getGamepads", () => [null, window.pad]);
}"""


def distances(service: str) -> dict[int, float]:
    """Return the focus distances of the demo by frame, metres."""
    answer = httpx.get(f"{service}/v1/shots/demo/focus-curve", params={"format": "json"}, timeout=120)
    return {round(row["timeCode"]): row["focusDistanceM"] for row in answer.raise_for_status().json()["samples"]}


def keys_of_focus(service: str) -> list[dict[str, Any]]:
    """Return the keys of the demo's focus distance."""
    answer = httpx.get(f"{service}/v1/shots/demo/camera/focus", params={"time": 1}, timeout=120).raise_for_status()
    keys: list[dict[str, Any]] = answer.json()["keys"].get("focusDistanceM", [])
    return keys


def kept_take(page: Page) -> dict[int, float]:
    """Return the distances of the take that was kept last, by frame, metres."""
    takes = json.loads(page.evaluate("localStorage.getItem('pullfocus.pulls')"))[0]["notes"]["takes"]
    return {round(takes[-1]["start"]) + at: 1 / max(w, 1e-9) for at, w in enumerate(takes[-1]["nearness"])}


def open_ring(page: Page) -> Locator:
    """Show the focus ring by its key, and return its dial."""
    wait_settled(page, time=1)
    page.locator(".focus-line").wait_for()
    page.keyboard.press("w")
    ring = page.get_by_role("slider", name="Focus ring")
    ring.wait_for()
    page.get_by_label("Speed of the recording").select_option(SPEED)
    return ring


def play_and_turn(page: Page, turn: str) -> None:
    """Turn the ring a little at each frame that plays, and wait until the shot has ended and the take is there."""
    page.evaluate(f"({HAND})({turn})")
    expect(page.get_by_role("button", name="Record")).to_be_visible()


def turned_by(ring: Locator, turn: Callable[[], object]) -> float:
    """Return how far the dial of the ring goes by an event of the browser's own."""
    before = ring.get_attribute("aria-valuenow") or ""
    turn()
    expect(ring).not_to_have_attribute("aria-valuenow", before)
    return float(ring.get_attribute("aria-valuenow") or 0) - float(before)


def check_few_keys(page: Page) -> None:
    """Check that the page offers few keys, near enough to the take."""
    outcome = page.locator(".outcome")
    assert 2 <= int(outcome.get_attribute("data-keys") or 0) <= MOST_KEYS
    assert 0 < float(outcome.get_attribute("data-error") or 1) <= TOLERANCE


def check_shot(page: Page, service: str, before: dict[int, float]) -> None:
    """Check that the shot has the focus of the take, before and after it that of before, and give it back by one undo."""
    expect(page.get_by_role("button", name="Undo: Focus by take 1")).to_be_enabled()
    take, now, keys = kept_take(page), distances(service), keys_of_focus(service)
    assert max(take.values()) > 1.15 * min(take.values())
    assert sum(min(take) <= key["time"] <= max(take) for key in keys) <= MOST_KEYS
    for frame, wanted in take.items():
        assert now[frame] == pytest.approx(wanted, rel=TOLERANCE * 1.02)
    for frame in before.keys() - take.keys():
        assert now[frame] == pytest.approx(before[frame], rel=TOLERANCE * 1.02)
    page.keyboard.press("Control+z")
    expect(page.get_by_role("button", name="Redo: Focus by take 1")).to_be_enabled()
    assert distances(service) == pytest.approx(before, rel=1e-9)


def test_a_pull_by_mouse_and_wheel_becomes_few_keys(page: Page, service: str) -> None:
    page.set_viewport_size(WIDE)
    before = distances(service)
    ring = open_ring(page)
    box = ring.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    start = float(ring.get_attribute("aria-valuenow") or 0)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 - 60, box["y"] + box["height"] / 2)
    page.mouse.up()
    assert float(ring.get_attribute("aria-valuenow") or 0) > start + 2  # the scale goes with the hand, to farther away
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    assert turned_by(ring, lambda: page.mouse.wheel(0, 400)) < 0
    page.get_by_role("button", name="Record").click()
    expect(page.get_by_text("Turn the ring to begin")).to_be_visible()
    play_and_turn(
        page,
        """(at, before) => document.querySelector("[aria-label='Focus ring']").dispatchEvent(
             new WheelEvent("wheel", { deltaY: 20 * (at - before), bubbles: true, cancelable: true }))""",
    )
    check_few_keys(page)
    assert page.locator(".take-line").count() == 1
    assert violations(page) == []
    page.set_viewport_size(PHONE)
    expect(ring).to_be_visible()
    page.wait_for_function("() => document.documentElement.scrollWidth <= innerWidth")
    assert violations(page) == []
    page.set_viewport_size(WIDE)
    page.get_by_role("button", name="Apply").click()
    check_shot(page, service, before)
    page.reload()
    expect(page.get_by_role("combobox", name="Take")).to_have_value("1")


def test_a_pull_by_keyboard_alone_becomes_few_keys(page: Page, service: str) -> None:
    before = distances(service)
    ring = open_ring(page)
    tab_to(page, ring)
    page.keyboard.press("1")
    expect(page.locator("[data-mark='1']")).to_have_count(1)
    assert turned_by(ring, lambda: [page.keyboard.press("ArrowLeft") for _ in range(4)]) < 0
    page.keyboard.press("Shift+w")
    expect(page.get_by_role("button", name="Stop", exact=True)).to_be_visible()
    play_and_turn(
        page,
        """(at, before) => {
          for (let press = Math.floor(before / 2); press < Math.floor(at / 2); press += 1)
            document.activeElement.dispatchEvent(
              new KeyboardEvent("keydown", { key: "ArrowLeft", bubbles: true, cancelable: true }));
        }""",
    )
    check_few_keys(page)
    tab_to(page, page.get_by_role("slider", name="Tolerance of the keys"))
    page.keyboard.press("ArrowLeft")
    assert float(page.locator(".outcome").get_attribute("data-error") or 1) <= 0.018
    page.keyboard.press("ArrowRight")
    check_few_keys(page)
    tab_to(page, page.get_by_role("button", name="Apply"))
    page.keyboard.press("Enter")
    check_shot(page, service, before)


def test_midi_and_a_game_controller_turn_the_ring(page: Page) -> None:
    page.add_init_script(f"({DEVICES})()")
    page.reload()
    ring = open_ring(page)
    page.get_by_role("button", name="Devices").click()
    assert page.evaluate("window.asked") == 0
    page.get_by_role("button", name="Connect MIDI").click()
    expect(page.get_by_text("Turn a knob or a fader")).to_be_visible()
    page.evaluate("() => { sendMidi(0xb0, 7, 100); sendMidi(0xb0, 39, 0); }")
    expect(page.get_by_text("Controller 7, channel 1")).to_be_visible()
    page.get_by_role("button", name="Use a game controller").click()
    expect(page.get_by_text("Move a stick or a trigger")).to_be_visible()
    assert violations(page) == []
    page.evaluate("() => { pad.axes[1] = 0.4; }")
    expect(page.get_by_text("Axis 1")).to_be_visible()
    page.keyboard.press("Escape")
    # The controller is looked at once for each frame; a move is told by two looks.
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    page.evaluate("() => { pad.axes[1] = 0.6; }")
    expect(ring).to_have_attribute("aria-valuenow", "80")

    page.keyboard.press("Shift+w")
    play_and_turn(
        page,
        """(at) => {
          const value = Math.round(12900 - 15 * at);
          sendMidi(0xb0, 7, value >> 7);
          sendMidi(0xb0, 39, value & 127);
        }""",
    )
    check_few_keys(page)
    page.get_by_role("button", name="Delete take 1").click()
    expect(page.locator(".outcome")).to_have_count(0)
    page.keyboard.press("Home")

    page.keyboard.press("Shift+w")
    play_and_turn(page, "(at) => { pad.axes[1] = 0.6 - 0.002 * at; }")
    check_few_keys(page)
