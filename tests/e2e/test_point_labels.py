"""Colours and groups of focus points in the page: shown wherever the point is, kept in USD, and undone."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from pxr import Usd

from tests.e2e.editor import FAR, NEAR, download, revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]


def test_points_have_a_colour_and_a_group(page: Page, service: str, tmp_path: Path) -> None:
    page.goto("/?shot=demo&time=40")
    wait_settled(page, time=40)
    row = page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {FAR}"))
    row.locator(".point-name").click()
    revision = revision_of(page)
    row.get_by_role("radio", name="teal").click()
    wait_edited(page, revision)
    expect(row).to_have_attribute("data-color", "teal")
    for place in (".track", ".lane", ".marker .tag"):
        expect(page.locator(f'{place}[data-color="teal"]')).to_have_count(1)
    for name in (FAR, NEAR):
        point = page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {name}"))
        point.locator(".point-name").click()
        revision = revision_of(page)
        group = point.get_by_label("Group")
        group.fill("cast")
        group.press("Enter")
        wait_edited(page, revision)
        expect(group).to_be_focused()
    expect(page.locator(".point[data-group=cast]")).to_have_count(2)
    page.get_by_role("button", name="cast", exact=True).click()
    expect(page.locator(".point")).to_have_count(1)  # the selected one
    revision = revision_of(page)
    page.get_by_role("checkbox", name="All of cast enabled").click()
    wait_edited(page, revision)
    edits = Usd.Stage.Open(str(download(page, "Edit layer (.usda)", tmp_path)))
    camera = edits.GetPrimAtPath("/World/main_cam")
    for name, color in ((FAR, "teal"), (NEAR, None)):
        read = {each: camera.GetAttribute(f"focusPoint:{name}:{each}").Get() for each in ("color", "group", "enabled")}
        assert read == {"color": color, "group": "cast", "enabled": False}
    for _ in range(4):
        revision = revision_of(page)
        page.keyboard.press("Control+z")
        wait_edited(page, revision)
    expect(page.locator("[data-color=teal].point")).to_have_count(0)
    expect(page.locator(".point-group")).to_have_count(0)
