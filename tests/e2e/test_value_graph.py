"""The curve of a keyed value in a real browser: keys and handles are dragged, nudged and added, and USD has what is shown."""

from __future__ import annotations

import httpx
import pytest
from playwright.sync_api import Locator, Page, expect
from pxr import Sdf, Ts, Usd

from tests.e2e.editor import NEAR, focus_points, revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


def test_keys_and_handles_are_dragged(page: Page, service: str) -> None:
    wait_settled(page)
    before = weight_keys(service)
    old = before[1]
    page.get_by_role("combobox", name="Curve").select_option(f"{NEAR}: Weight")
    revision = revision_of(page)
    drag(page, knot_at(page, old["time"]), frames=-4, share=0.3)
    revision = wait_edited(page, revision)
    moved = weight_keys(service)[1]
    assert moved["time"] == old["time"] - 4
    assert 0.4 < moved["value"] < 0.9
    expect(page.get_by_role("textbox", name="Value of Weight")).to_have_value(f"{moved['value']:.3g}")

    handle = page.locator('[data-handle="out"]')
    drag(page, handle, frames=3, share=-0.2)
    revision = wait_edited(page, revision)
    turned = weight_keys(service)[1]["tangents"]
    assert turned["outWidth"] > old["tangents"]["outWidth"] + 2
    assert turned["outSlope"] == turned["inSlope"] > 0
    assert turned["inWidth"] == pytest.approx(moved["tangents"]["inWidth"])
    expect(handle).to_have_attribute("aria-label", label_of("after", moved["time"], turned))
    assert usd_keys(service) == [pytest.approx(numbers(key), abs=1e-6) for key in weight_keys(service)]

    for _ in range(2):
        page.keyboard.press("Control+z")
        revision = wait_edited(page, revision)
    assert weight_keys(service) == before


def test_the_keyboard_alone_shapes_a_curve(page: Page, service: str) -> None:
    wait_settled(page)
    before = weight_keys(service)
    time = before[1]["time"]
    page.get_by_role("combobox", name="Curve").focus()
    page.keyboard.type(f"{NEAR}: W")
    knot_at(page, time).focus()
    revision = revision_of(page)
    for _ in range(2):
        page.keyboard.press("ArrowDown")
        revision = wait_edited(page, revision)
    assert weight_keys(service)[1]["value"] == pytest.approx(before[1]["value"] - 0.1)
    expect(page.locator(":focus")).to_have_attribute("data-knot", f"point {NEAR}@{time:g}")

    page.keyboard.press("Tab")
    expect(page.locator(":focus")).to_have_attribute("data-handle", "in")
    page.keyboard.press("ArrowLeft")
    revision = wait_edited(page, revision)
    widths = [keys[1]["tangents"]["inWidth"] for keys in (before, weight_keys(service))]
    assert widths[1] == pytest.approx(widths[0] + 1)
    expect(page.locator(":focus")).to_have_attribute("data-handle", "in")
    for _ in range(3):
        page.keyboard.press("Control+z")
        revision = wait_edited(page, revision)
    assert weight_keys(service) == before


def test_a_double_click_adds_a_key_on_the_curve(page: Page, service: str) -> None:
    wait_settled(page)
    before = weight_keys(service)
    page.get_by_role("combobox", name="Curve").select_option(f"{NEAR}: Weight")
    bed, graph = page.locator(".scrub-bed").bounding_box(), page.locator(".graph").bounding_box()
    assert bed is not None
    assert graph is not None
    revision = revision_of(page)
    page.mouse.dblclick(bed["x"] + bed["width"] * 54 / 95, graph["y"] + graph["height"] / 2)
    revision = wait_edited(page, revision)
    [added] = [key for key in weight_keys(service) if key["time"] not in [old["time"] for old in before]]
    assert (added["time"], added["value"]) == (55, pytest.approx(0.5, abs=1e-6))  # half way from 44 to 66
    expect(page.locator(".knot.selected")).to_have_attribute("data-knot", f"point {NEAR}@55")
    page.keyboard.press("Control+z")
    revision = wait_edited(page, revision)
    assert weight_keys(service) == before

    # Where there is a key, and beside the shot, nothing is added.
    page.mouse.dblclick(bed["x"] + bed["width"] * 43 / 95, graph["y"] + graph["height"] / 2)
    expect(page.locator(".knot.selected")).to_have_attribute("data-knot", f"point {NEAR}@44")
    page.mouse.dblclick(bed["x"] - 40, graph["y"] + graph["height"] / 2)
    assert weight_keys(service) == before
    assert revision_of(page) == revision


def test_the_wheel_and_the_keyboard_show_a_part_of_the_shot(page: Page) -> None:
    wait_settled(page)
    bed = page.locator(".scrub-bed").bounding_box()
    assert bed is not None
    at = bed["x"] + bed["width"] * 43 / 95  # frame 44, which has a key
    page.mouse.move(at, bed["y"] + 5)
    page.mouse.wheel(0, -150)
    whole = page.get_by_role("button", name="Whole shot")
    expect(whole).to_be_visible()
    key = page.locator(f'[data-stack="point {NEAR}@44"]').bounding_box()
    assert key is not None
    assert key["x"] + key["width"] / 2 == pytest.approx(at, abs=12)
    expect(page.locator(f'[data-stack="point {NEAR}@96"]')).not_to_be_visible()

    page.locator(f'[data-stack="point {NEAR}@44"]').click()
    page.locator(f'[data-stack="point {NEAR}@66"]').click(modifiers=["Shift"])
    page.keyboard.press("f")
    shown = [page.locator(f'[data-stack="point {NEAR}@{time}"]').bounding_box() for time in (44, 66)]
    assert shown[0] is not None
    assert shown[1] is not None
    assert shown[1]["x"] - shown[0]["x"] > 0.7 * bed["width"]
    whole.click()
    expect(whole).to_have_count(0)
    expect(page.locator(f'[data-stack="point {NEAR}@96"]')).to_be_visible()
    page.keyboard.press("+")
    expect(whole).to_be_visible()
    page.keyboard.press("-")
    expect(whole).to_have_count(0)


def weight_keys(service: str) -> list[dict]:
    """Return the keys of the near subject's weight."""
    return focus_points(service, 1)[NEAR]["keys"]["weight"]


def knot_at(page: Page, time: float) -> Locator:
    """Return the key at a time of the curve that is drawn."""
    return page.locator(f'[data-knot="point {NEAR}@{time:g}"]')


def label_of(side: str, time: float, tangents: dict) -> str:
    """Return what a screen reader says of a handle."""
    slope = float(f"{tangents['outSlope']:.4f}")
    return f"Handle {side} frame {time:g}: slope {slope:g} a frame, {frame(tangents['outWidth'])} frames long"


def frame(number: float) -> str:
    """Return a number of frames as the page writes it."""
    return f"{number:g}" if float(number).is_integer() else f"{number:.2f}"


def numbers(key: dict) -> list[float]:
    """Return time, value and handles of a key."""
    return [
        key["time"],
        key["value"],
        *(key["tangents"][name] for name in ("inSlope", "inWidth", "outSlope", "outWidth")),
    ]


def usd_keys(service: str) -> list[list[float]]:
    """Read the keys of the near subject's weight out of the edit layer, by usd-core alone."""
    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(httpx.get(f"{service}/v1/shots/demo/edits", timeout=120).text)
    stage = Usd.Stage.Open(layer)
    spline: Ts.Spline = stage.GetPrimAtPath("/World/main_cam").GetAttribute(f"focusPoint:{NEAR}:weight").GetSpline()
    return [
        [
            knot.GetTime(),
            knot.GetValue(),
            knot.GetPreTanSlope(),
            knot.GetPreTanWidth(),
            knot.GetPostTanSlope(),
            knot.GetPostTanWidth(),
        ]
        for knot in spline.GetKnots().values()
    ]


def drag(page: Page, handle: Locator, frames: float, share: float) -> None:
    """Drag something of the graph, by a number of frames to the right and by a share of its height down."""
    box, bed, graph = (place.bounding_box() for place in (handle, page.locator(".scrub-bed"), page.locator(".graph")))
    assert box is not None
    assert bed is not None
    assert graph is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for part in (0.5, 1):
        page.mouse.move(x + part * bed["width"] * frames / 95, y + part * graph["height"] * share)
    page.mouse.up()
