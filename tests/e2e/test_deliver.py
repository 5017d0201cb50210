"""Frames, a movie and a focus report are delivered from the page, as jobs with progress, by the keyboard alone."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import av
import httpx
import numpy as np
import OpenImageIO as oiio
import pytest
from playwright.sync_api import Locator, Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import tab_to, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

WIDTH = 48


def open_form(page: Page) -> Locator:
    """Open the form by its key and return the dialog; the frames have the keyboard."""
    page.keyboard.press("Alt+Shift+d")
    dialog = page.get_by_role("dialog", name="Renders")
    expect(dialog.get_by_role("textbox", name="Frames")).to_be_focused()
    return dialog


def type_in(page: Page, dialog: Locator, **texts: str) -> None:
    for name, text in texts.items():
        tab_to(page, dialog.get_by_role("textbox", name=name))
        page.keyboard.press("Control+a")
        page.keyboard.type(text)


def check(page: Page, box: Locator) -> None:
    tab_to(page, box)
    page.keyboard.press("Space")
    expect(box).to_be_checked()


def send(page: Page, dialog: Locator, name: str) -> Locator:
    """Send the form by its button, and return the row of the render."""
    tab_to(page, dialog.get_by_role("button", name="Send"))
    page.keyboard.press("Enter")
    head = dialog.get_by_role("button", name=name)
    expect(head).to_be_focused()
    return dialog.get_by_role("listitem").filter(has=page.get_by_role("button", name=name)).first


def fetched(page: Page, link: Locator) -> Path:
    tab_to(page, link)
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    return download.value.path()


def note_progress(page: Page) -> None:
    """Note each state that a product of a render is shown in."""
    page.evaluate(
        """() => {
          window.seen = new Set();
          const look = () => {
            for (const item of document.querySelectorAll('.product')) window.seen.add(item.className);
          };
          new MutationObserver(look).observe(document.body, { subtree: true, childList: true, attributes: true });
        }"""
    )


def test_movie_exr_range_and_report_are_delivered(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    note_progress(page)
    dialog = open_form(page)
    page.keyboard.press("Control+a")
    page.keyboard.type("1-3")
    check(page, dialog.get_by_role("checkbox", name="Movie"))
    check(page, dialog.get_by_role("checkbox", name="Focus report"))
    kind = dialog.get_by_role("combobox", name="Format of the focus report")
    tab_to(page, kind)
    page.keyboard.press("ArrowDown")
    expect(kind).to_have_value("csv")
    type_in(page, dialog, Width=str(WIDTH), Rays="4", Name="dailies")
    assert violations(page) == []
    row = send(page, dialog, "dailies")
    bar = row.get_by_role("progressbar", name="Progress of dailies")
    expect(bar).to_have_attribute("aria-valuemax", "5")
    made = row.get_by_role("list", name="What is made of dailies")
    expect(made.get_by_role("listitem")).to_have_count(2)
    expect(row).to_contain_text("3 of 3 frames, 2 of 2 products")
    expect(row).to_contain_text("Done")
    expect(bar).to_have_attribute("aria-valuenow", "5")
    seen = page.evaluate("() => [...window.seen]")
    assert {"product is-waiting", "product is-done"} <= set(seen)
    assert violations(page) == []

    with av.open(str(fetched(page, made.get_by_role("link", name="Download movie (.mp4)")))) as movie:
        assert len(list(movie.decode(movie.streams.video[0]))) == 3
    report = fetched(page, made.get_by_role("link", name="Download focus report (.csv)"))
    rows = list(csv.DictReader(io.StringIO(report.read_text())))
    assert [row["frame"] for row in rows] == ["1", "1", "2", "2", "3", "3"]  # of two focus points
    assert all(float(row["focus_distance_m"]) > 0 for row in rows)

    (render,) = httpx.get(f"{service}/v1/renders", timeout=120).raise_for_status().json()["renders"]
    assert [(each["name"], each["state"]) for each in render["products"]] == [
        ("movie.mp4", "done"),
        ("focus-report.csv", "done"),
    ]
    assert render["formats"] == ["exr", "png"]
    cells = row.get_by_role("listbox", name="Frames of dailies")
    tab_to(page, cells)
    for key in ("Home", "ArrowRight"):
        page.keyboard.press(key)
    frame = fetched(page, page.get_by_role("link", name="Download frame 2 (.exr"))
    pixels = oiio.ImageBuf(str(frame)).get_pixels(oiio.FLOAT)
    assert pixels.shape[1] == WIDTH
    assert np.isfinite(pixels).all()
    assert pixels[..., :3].max() > 0


def test_a_report_alone_draws_nothing_and_is_remembered(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    dialog = open_form(page)
    whole = dialog.get_by_role("button", name="Whole shot")
    expect(whole).to_have_attribute("aria-pressed", "true")
    now = dialog.get_by_role("button", name="This frame")
    tab_to(page, now)
    page.keyboard.press("Enter")
    expect(dialog.get_by_role("textbox", name="Frames")).to_have_value("1")
    frames = dialog.get_by_role("checkbox", name="Frames")
    tab_to(page, frames)
    page.keyboard.press("Space")
    expect(frames).not_to_be_checked()
    expect(dialog.get_by_role("alert").filter(has_text="Choose what to make.")).to_be_visible()
    check(page, dialog.get_by_role("checkbox", name="Focus curve"))
    expect(dialog.get_by_role("button", name="Burn-ins")).to_have_count(0)
    expect(dialog.locator(".render-plan")).to_contain_text("No frame is drawn")
    type_in(page, dialog, Name="curve alone")
    row = send(page, dialog, "curve alone")
    expect(row).to_contain_text("1 of 1 product")
    layer = fetched(page, row.get_by_role("link", name="Download focus curve (.usda)"))
    assert layer.read_text().startswith("#usda 1.0")
    render = httpx.get(f"{service}/v1/renders", timeout=120).raise_for_status().json()["renders"][0]
    assert (render["count"], render["formats"], render["state"]) == (0, [], "done")
    tab_to(page, dialog.get_by_role("button", name="Render…"))
    page.keyboard.press("Enter")
    expect(dialog.get_by_role("checkbox", name="Focus curve")).to_be_checked()
    expect(dialog.get_by_role("checkbox", name="Frames")).not_to_be_checked()
