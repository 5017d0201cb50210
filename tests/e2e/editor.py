"""Actions on the editor in a real browser, and readings from its page."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path
from typing import Any

import httpx
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Locator, Page, Response, expect
from scipy.ndimage import gaussian_laplace

NEAR, FAR = "pip", "mara"  # the demo's two subjects, and the names of the focus points on them
LAST_FRAME = 96.0


def wait_settled(page: Page, **attributes: float) -> Locator:
    """Wait until the best picture of the present state is on screen."""
    selector = "".join(f'[data-{name}="{value:g}"]' for name, value in attributes.items())
    canvas = page.locator(f"canvas[data-settled=true]{selector}")
    canvas.wait_for()
    return canvas


def wait_edited(page: Page, revision: int) -> int:
    """Wait until the best picture after an edit is on screen, and return its revision."""
    page.wait_for_function(
        """(old) => { const c = document.querySelector("canvas[data-settled=true]");
                      return c !== null && Number(c.dataset.revision) > old; }""",
        arg=revision,
    )
    return revision_of(page)


def revision_of(page: Page) -> int:
    """Return the number of edits that the picture on screen includes."""
    return int(page.locator("canvas").get_attribute("data-revision") or -1)


def is_edit(answer: Response) -> bool:
    """Whether an answer is that to an edit."""
    return answer.request.method == "POST" and answer.url.endswith("/edits")


def shown_picture(page: Page) -> NDArray[np.float64]:
    """Return the luminance ``(height, width)``, 0 to 1, of the picture alone, without markers and guides."""
    address = page.locator("canvas").evaluate("canvas => canvas.toDataURL('image/png')")
    pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(address.split(",")[1]))).convert("RGB"), np.float64)
    return pixels @ (0.2126, 0.7152, 0.0722) / 255


def sharpness(image: NDArray[np.float64], at: tuple[float, float], reach: float = 0.05) -> float:
    """Measure the detail around a point of a picture: the variance of its Laplacian, at the scale of a pixel.

    Args:
        image: ``(height, width)``.
        at: 0 to 1 from the top left corner.
        reach: half the window, in picture widths.
    """
    height, width = image.shape
    x, y, r = round(at[0] * width), round(at[1] * height), round(reach * width)
    window = gaussian_laplace(image, 1)[max(y - r, 0) : y + r, max(x - r, 0) : x + r]
    return float(window.var())


def focus_points(service: str, time: float) -> dict[str, Any]:
    """Return the service's focus points at a time, by name."""
    answer = httpx.get(f"{service}/v1/shots/demo/focus-points", params={"time": time}, timeout=120).raise_for_status()
    return {point["name"]: point for point in answer.json()["focusPoints"]}


def click_on(page: Page, at: tuple[float, float]) -> None:
    """Click at a point of the picture, 0 to 1 from its top left corner."""
    box = page.locator("canvas").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + at[0] * box["width"], box["y"] + at[1] * box["height"])


def scrub_to(page: Page, frame: float) -> None:
    """Drag the playhead to a frame."""
    tick = page.locator(".scrub-bed").bounding_box()
    assert tick is not None
    x = tick["x"] + tick["width"] * (frame - 1) / (LAST_FRAME - 1)
    page.mouse.move(tick["x"] + 2, tick["y"] + 8)
    page.mouse.down()
    page.mouse.move((tick["x"] + x) / 2, tick["y"] + 8)
    page.mouse.move(x, tick["y"] + 8)
    page.mouse.up()


def download(page: Page, entry: str, folder: Path) -> Path:
    """Download an entry of the download menu and return its path."""
    page.get_by_role("button", name="Download").click()
    with page.expect_download() as started:
        page.get_by_role("button", name=entry, exact=True).click()
    path = folder / started.value.suggested_filename
    started.value.save_as(path)
    return path


def metres(text: str) -> float:
    """Parse a distance that the page shows, in metres."""
    return float("inf") if text == "∞" else float(re.sub(r"[^\d.]", "", text))


def readout_m(page: Page, name: str) -> float:
    """Return a distance of the depth-of-field readout, in metres."""
    return metres(page.locator(f"[data-reading={name}]").inner_text())


def choose_file(page: Page, file: Path, button: str) -> None:
    """Press a button that asks for a file, and choose one."""
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name=button).click()
    chooser.value.set_files(file)


def tab_to(page: Page, place: Locator) -> None:
    """Go to an element by the Tab key."""
    for _ in range(160):
        if place.evaluate("place => place === document.activeElement"):
            break
        page.keyboard.press("Tab")
    expect(place).to_be_focused()
