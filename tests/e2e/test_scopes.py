"""Scopes of the picture on screen in a real browser, against numpy on the same picture."""

from __future__ import annotations

import base64
import io
import re

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from tests.e2e.axe import violations
from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

Counts = NDArray[np.int64]
CHANNELS = ("red", "green", "blue", "luma")


def pixels(canvas: Locator) -> Counts:
    """Return the bytes ``(height, width, 3)`` of a canvas."""
    address = canvas.evaluate("canvas => canvas.toDataURL('image/png')")
    return np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGB")).astype(np.int64)


def wait_counted(page: Page, time: float) -> Counts:
    """Wait until the scopes are those of the best picture, and return its bytes."""
    canvas = wait_settled(page, time=time)
    revision = canvas.get_attribute("data-revision")
    page.locator(f'.scopes[data-stage=final][data-time="{time:g}"][data-revision="{revision}"]').wait_for()
    # opening the scopes makes the picture smaller, which is drawn anew
    page.wait_for_function(
        """() => {
          const [canvas, scopes] = [".picture canvas", ".scopes"].map((name) => document.querySelector(name));
          const wide = document.querySelector(".picture").getBoundingClientRect().width * devicePixelRatio;
          return canvas.dataset.settled === "true" && scopes.dataset.stage === "final"
            && scopes.dataset.width === String(canvas.width) && Math.abs(canvas.width - wide) < 2;
        }"""
    )
    return pixels(canvas)


def levels_of(picture: Counts) -> dict[str, Counts]:
    """Return the levels ``(height, width)`` of each channel and of the luma of Rec. 709."""
    red, green, blue = np.moveaxis(picture, -1, 0)
    return {"red": red, "green": green, "blue": blue, "luma": (2126 * red + 7152 * green + 722 * blue + 5000) // 10000}


def brightness(counts: Counts, full: float) -> Counts:
    """Return how bright counts are drawn, 0 to 255."""
    drawn: Counts = np.rint(255 * np.sqrt(np.minimum(counts / full, 1))).astype(np.int64)
    return drawn


def check_histogram(page: Page, picture: Counts) -> None:
    for name, levels in levels_of(picture).items():
        outline = page.locator(f".scope.across path[data-channel={name}]").get_attribute("d") or ""
        counts = [int(count) for count in re.findall(r"V(\d+)h1", outline)]
        np.testing.assert_array_equal(counts, np.bincount(levels.ravel(), minlength=256), name)


def check_waveforms(page: Page, picture: Counts) -> None:
    height, width, _ = picture.shape
    columns = min(width, 512)
    column = np.broadcast_to(np.arange(width) * columns // width, (height, width))
    for name, levels in levels_of(picture).items():
        counts = np.zeros((256, columns), np.int64)
        np.add.at(counts, (255 - levels, column), 1)
        drawn = pixels(page.locator(f".scope.up canvas[data-channel={name}]")).max(axis=-1)
        np.testing.assert_array_equal(drawn, brightness(counts, 0.1 * height * width / columns), name)


def check_vectorscope(page: Page, picture: Counts) -> None:
    red, green, blue = np.moveaxis(picture, -1, 0)
    luma = 2126 * red + 7152 * green + 722 * blue
    # B − Y over 1.8556 and R − Y over 1.5748, in whole numbers: rounded, halves up.
    chroma = ((10000 * one - luma, round(10000 * by)) for one, by in ((blue, 1.8556), (red, 1.5748)))
    cb, cr = (np.minimum((2 * above + by) // (2 * by), 127) for above, by in chroma)
    counts = np.zeros((256, 256), np.int64)
    np.add.at(counts, (127 - cr, 128 + cb), 1)
    drawn = pixels(page.locator(".vectorscope canvas")).max(axis=-1)
    np.testing.assert_array_equal(drawn, brightness(counts, 0.001 * luma.size))


def check_figures(page: Page, picture: Counts) -> None:
    mean = (picture @ (0.2126, 0.7152, 0.0722)).mean() / 255
    shares = {"mean": mean, "low": (picture == 0).any(axis=-1).mean(), "high": (picture == 255).any(axis=-1).mean()}
    for name, share in shares.items():
        said = page.locator(f"[data-figure={name}]").inner_text()
        assert float(said.removesuffix(" %")) == pytest.approx(100 * share, abs=0.051), name


def test_the_scopes_are_those_of_the_picture(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Shift+H")
    first = wait_counted(page, 1)
    for time, picture in ((1, first), (96, None)):
        if picture is None:
            page.keyboard.press("End")
            picture = wait_counted(page, time)
            assert not np.array_equal(picture, first)
        check_histogram(page, picture)
        check_waveforms(page, picture)
        check_vectorscope(page, picture)
        check_figures(page, picture)
    assert violations(page) == []


def test_scopes_are_chosen_by_mouse_and_remembered(page: Page) -> None:
    wait_settled(page, time=1)
    page.get_by_role("button", name="Tools on the picture").click()
    page.get_by_role("checkbox", name="Scopes").check()
    page.keyboard.press("Escape")
    shown = page.get_by_role("group", name="Scopes that are shown")
    for name in ("Waveform", "Parade", "Vectorscope"):
        shown.get_by_role("button", name=name).click()
    page.get_by_role("img", name="Histogram of red, green, blue and luma").wait_for()
    expect(page.locator(".scope")).to_have_count(1)
    page.reload()
    expect(page.locator(".scope")).to_have_count(1)
    page.get_by_role("button", name="Close the scopes").click()
    expect(page.locator(".scopes")).to_have_count(0)
    page.keyboard.press("Shift+H")
    expect(page.locator(".scope")).to_have_count(1)


def test_scopes_follow_while_playing(page: Page) -> None:
    wait_settled(page, time=1)
    page.keyboard.press("Shift+H")
    wait_counted(page, 1)
    page.keyboard.press(" ")
    times = page.evaluate(
        """() => new Promise((done) => {
            const seen = new Set(), scopes = document.querySelector(".scopes");
            new MutationObserver(() => {
              seen.add(scopes.dataset.time);
              if (seen.size > 2) done([...seen].map(Number));
            }).observe(scopes, { attributes: true, attributeFilter: ["data-time"] });
        })"""
    )
    page.keyboard.press("k")
    assert len(times) == 3
