"""Renders from the page: sent with what it shows, followed until they are done, looked at and removed."""

from __future__ import annotations

import io
import json
import re

import httpx
import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Locator, Page, Request, ViewportSize, expect

from tests.e2e.axe import violations
from tests.e2e.editor import wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

PHONE: ViewportSize = {"width": 390, "height": 844}
WIDE: ViewportSize = {"width": 1280, "height": 640}  # with room for the button


def test_a_render_is_sent_followed_and_removed(page: Page, service: str) -> None:
    wait_settled(page, time=1)
    page.get_by_role("button", name="Download").click()
    page.get_by_role("button", name="Deliver…").click()
    dialog = page.get_by_role("dialog", name="Renders")
    frames = dialog.get_by_role("textbox", name="Frames")
    expect(frames).to_be_focused()
    expect(frames).to_have_value("1-96")
    assert violations(page) == []
    check_faults(page)

    frames.fill("1-2")
    dialog.get_by_role("textbox", name="Width").fill("64")
    dialog.get_by_role("textbox", name="Rays").fill("4")
    dialog.get_by_role("combobox", name="Files").select_option("png")
    dialog.get_by_role("textbox", name="Name").fill("two small ones")
    expect(dialog.locator(".render-plan")).to_contain_text("2 frames, about ")
    expect(dialog.locator(".render-plan")).to_contain_text(" px, ")
    sent: list[Request] = []
    page.on("request", lambda request: request.method == "POST" and sent.append(request))
    dialog.get_by_role("button", name="Send").dblclick()

    row = dialog.get_by_role("listitem").filter(has_text="two small ones")
    expect(row.get_by_role("button", name="two small ones")).to_be_focused()
    expect(row).to_have_count(1)
    expect(row).to_contain_text("2 of 2 frames")
    expect(row).to_contain_text("Done")
    check_request(sent, service)
    check_frames(page, service)

    row.get_by_role("button", name="Remove").click()
    question = row.get_by_role("group", name="Remove two small ones?")
    expect(question.get_by_role("button", name="Remove")).to_be_focused()
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")  # keeps it
    expect(row.get_by_role("button", name="two small ones")).to_be_focused()
    row.get_by_role("button", name="Remove").click()
    question.get_by_role("button", name="Remove").click()
    expect(row).to_have_count(0)
    expect(dialog).to_contain_text("Nothing was rendered yet")
    expect(dialog.get_by_role("button", name="Render…")).to_be_focused()
    assert httpx.get(f"{service}/v1/renders", timeout=120).json()["renders"] == []
    page.keyboard.press("Escape")
    expect(dialog).to_have_count(0)


def check_faults(page: Page) -> None:
    """Check that what is wrong is said at its field, and that nothing is sent then."""
    frames = page.get_by_role("textbox", name="Frames")
    rays = page.get_by_role("textbox", name="Rays")
    rays.fill("many")
    expect(rays).to_have_attribute("aria-invalid", "true")
    expect(rays).to_have_accessible_description("Type a whole number, such as 100.")
    page.get_by_role("button", name="Send").click()
    expect(rays).to_be_focused()
    rays.fill("4")
    frames.fill("5-1")
    expect(frames).to_have_accessible_description("The step of '5-1' does not lead from its first frame to its last.")
    assert violations(page) == []


def check_request(sent: list[Request], service: str) -> None:
    """Check that one render was sent, with a key, as it was typed."""
    requests = [request for request in sent if request.url == f"{service}/v1/renders"]
    assert [len(request.header_value("idempotency-key") or "") for request in requests] == [32]
    (render,) = httpx.get(f"{service}/v1/renders", timeout=120).json()["renders"]
    wanted = {"shot": "demo", "frames": "1-2", "width": 64, "rays": 4, "formats": ["png"], "priority": 50}
    assert wanted.items() <= render.items()


def check_frames(page: Page, service: str) -> None:
    """Check the cells of the frames by keyboard, and the picture of one, on a wide page and on a phone."""
    cells = page.get_by_role("listbox", name="Frames of two small ones")
    cells.focus()
    page.keyboard.press("Home")
    page.keyboard.press("ArrowRight")
    expect(cells.get_by_role("option", name="Frame 2: drawn")).to_have_attribute("aria-selected", "true")
    picture = page.get_by_role("img", name="Frame 2 of two small ones")
    expect(picture).to_have_js_property("naturalWidth", 64)
    expect(page.get_by_role("list", name="Attempts at frame 2").get_by_role("listitem")).to_have_count(1)
    with page.expect_download() as download:
        page.get_by_role("link", name="Download frame 2").click()
    assert download.value.suggested_filename == "two small ones.0002.png"
    camera = page.locator(".crumbs select").input_value()  # the dialog covers it
    shown = {"time": 2, "camera": camera, "width": 64, "rays": 4, "format": "png"}
    direct = httpx.get(f"{service}/v1/shots/demo/frame", params=shown, timeout=120).raise_for_status()
    np.testing.assert_array_equal(Image.open(download.value.path()), Image.open(io.BytesIO(direct.content)))
    shown = page.get_by_role("button", name="Show log")
    shown.click()
    log = page.get_by_role("log", name="Log of attempt 1 at frame 2")
    expect(log).to_contain_text("stored png: ")
    expect(log).to_contain_text("load scene: ")
    assert violations(page) == []
    wide = page.viewport_size
    assert wide is not None
    page.set_viewport_size(PHONE)
    assert violations(page) == []
    assert page.evaluate("document.querySelector('.renders-body').scrollWidth <= innerWidth")
    page.set_viewport_size(wide)


def test_a_render_waits_with_aovs_and_a_focus_report(page: Page, service: str) -> None:
    with httpx.Client(base_url=service, timeout=120) as client:
        failing = {"shot": "demo", "name": "first", "camera": "/World/none", "frames": "1", "width": 16}
        first = client.post("/v1/renders", json=failing).json()["id"]  # which fails, so that the other one waits
        dialog = open_form(page, name="second")
        choose_aovs(dialog)
        waits = dialog.get_by_role("button", name="Wait for")
        waits.click()
        offered = dialog.get_by_role("group", name="Renders that have to be done before")
        offered.get_by_role("checkbox", name="first").check()
        expect(waits).to_have_accessible_name("Wait for first")
        assert violations(page) == []
        expect(dialog.locator(".render-plan")).to_contain_text("2 frames, about ")
        dialog.get_by_role("button", name="Send").click()

        row = dialog.get_by_role("listitem").filter(has=page.get_by_role("button", name="second"))
        expect(row).to_contain_text("AOVs depth, normal, primvars:st")
        expect(row).to_contain_text("Waits for first")
        second, _ = client.get("/v1/renders").json()["renders"]
        assert (second["aovs"], second["waitsFor"]) == (["depth", "normal", "primvars:st"], [first])
        check_reports(page)
        check_remembered(page)
        client.post(f"/v1/renders/{second['id']}/cancel").raise_for_status()
        expect(dialog).to_contain_text("Ended with failures")
        for render in (second["id"], first):
            client.delete(f"/v1/renders/{render}").raise_for_status()


def open_form(page: Page, name: str) -> Locator:
    """Open the dialog with the form of a render of two small frames, and return it."""
    wait_settled(page, time=1)
    page.keyboard.press("Alt+Shift+r")
    dialog = page.get_by_role("dialog", name="Renders")
    for field, text in {"Frames": "1-2", "Width": "16", "Name": name}.items():
        dialog.get_by_role("textbox", name=field).fill(text)
    return dialog


def choose_aovs(dialog: Locator) -> None:
    """Choose AOVs by keyboard, and see that a nameless primvar is refused at its field."""
    aovs = dialog.get_by_role("button", name="AOVs")
    expect(aovs).to_have_accessible_name("AOVs none")
    dialog.get_by_role("combobox", name="Files").select_option("png")
    expect(aovs).to_have_count(0)
    dialog.get_by_role("combobox", name="Files").select_option("both")
    aovs.press("Enter")
    group = dialog.get_by_role("group", name="AOVs in the EXR files")
    for name in ("normal", "depth"):
        group.get_by_role("checkbox", name=name, exact=True).press("Space")
    expect(group.get_by_role("checkbox", name="depth", exact=True)).to_have_accessible_description(
        "metres along the view axis; infinite where nothing is"
    )
    primvars = dialog.get_by_role("textbox", name="Primvars")
    primvars.fill("primvars:")
    expect(primvars).to_have_accessible_description("Type a name behind primvars:, such as primvars:st.")
    primvars.fill("st")
    expect(aovs).to_have_accessible_name("AOVs depth, normal, primvars:st")


def check_reports(page: Page) -> None:
    """Check that the focus report is there before the first frame is, in each format."""
    files = page.get_by_role("group", name="Files of all frames of second")
    texts = [f"Download focus report (.{kind})" for kind in ("html", "csv", "json")]
    expect(files.get_by_role("link")).to_have_text(texts)
    contents = []
    for link in files.get_by_role("link").all():
        with page.expect_download() as download:
            link.click()
        contents.append(download.value.path().read_text())
    shown, table, report = contents
    assert "Who is sharp when" in shown
    assert table.startswith("frame,focus_distance_m")
    assert json.loads(report)["frames"] == "1-2"


def check_remembered(page: Page) -> None:
    """Check that the next render has the AOVs of the last one, and waits for none."""
    page.get_by_role("dialog").get_by_role("button", name="Render…").click()
    aovs = page.get_by_role("button", name=re.compile("^AOVs"))
    expect(aovs).to_have_accessible_name("AOVs depth, normal, primvars:st")
    expect(page.get_by_role("button", name="Wait for")).to_have_accessible_name("Wait for no other render")
    page.set_viewport_size(PHONE)
    aovs.click()
    assert violations(page) == []
    assert page.evaluate("document.querySelector('.renders-body').scrollWidth <= innerWidth")


def test_the_list_of_renders_comes_when_it_is_wanted(page: Page) -> None:
    files: list[str] = []
    page.on("request", lambda request: files.append(request.url))
    page.reload()
    wait_settled(page, time=1)
    assert not [url for url in files if "RendersPanel" in url or url.endswith("/v1/renders?most=50")]
    page.set_viewport_size(WIDE)
    page.get_by_role("button", name="Renders").click()
    expect(page.get_by_role("dialog").get_by_role("button", name="Render…")).to_be_visible()
    assert violations(page) == []
    page.get_by_role("button", name="Close").click()
    expect(page.get_by_role("dialog")).to_have_count(0)
