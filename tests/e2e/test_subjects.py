"""Subjects in the page: a focus point follows a part from where it is, and undo puts it on its surface again."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Page, expect
from pxr import Usd

from tests.e2e.editor import FAR, download, focus_points, revision_of, wait_edited, wait_settled

pytestmark = [pytest.mark.e2e, pytest.mark.gl]

FRAME = 40
MARA = "/World/Cast/Mara"


def test_a_point_follows_a_part_from_where_it_is(page: Page, service: str, tmp_path: Path) -> None:
    page.goto(f"/?shot=demo&time={FRAME}")
    wait_settled(page, time=FRAME)
    before, later = focus_points(service, FRAME)[FAR], focus_points(service, 80)[FAR]
    row = page.locator(".point").filter(has=page.get_by_role("button", name=f"Remove {FAR}"))
    row.locator(".point-name").click()
    follows = row.get_by_label("Follows")
    options = follows.locator("option").all_inner_texts()
    assert options == ["This place on VisorGlow", "All of VisorGlow", "Head", "Body", "Mara", "Cast"]
    revision = revision_of(page)
    follows.select_option("Mara")
    wait_edited(page, revision)
    expect(row.locator(".point-name")).to_contain_text("follows Mara")
    expect(follows.locator("..")).to_have_attribute(
        "title", "Follows the bounds of Mara, so that the point stays with it when its mesh changes"
    )
    subject = focus_points(service, FRAME)[FAR]
    assert (subject["part"], subject["target"], subject["face"]) == (MARA, before["target"], before["face"])
    assert subject["positionM"] == pytest.approx(before["positionM"], abs=1e-6)
    assert focus_points(service, 80)[FAR]["positionM"] != pytest.approx(later["positionM"], abs=1e-3), "bounds breathe"
    edits = Usd.Stage.Open(str(download(page, "Edit layer (.usda)", tmp_path)))
    camera = edits.GetPrimAtPath("/World/main_cam")
    (part,) = camera.GetRelationship(f"focusPoint:{FAR}:part").GetTargets()
    assert str(part) == MARA
    revision = revision_of(page)
    page.keyboard.press("Control+z")
    expect(row.locator(".point-name")).not_to_contain_text("follows")
    expect(follows).to_have_value("")
    assert focus_points(service, FRAME)[FAR] == before
