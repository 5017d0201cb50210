"""Bounds of focus reports."""

from __future__ import annotations

import pytest

from render.errors import SettingsError
from service.models.focus_reports import ReportedRender
from service.stage import focus_reports
from service.stage.opened import OpenedShot
from usd_schemas import FocusPoint


@pytest.mark.parametrize(("frames", "fits"), [(5, True), (6, False)])
def test_a_report_has_so_many_rows_and_no_more(record, monkeypatch, frames, fits):
    monkeypatch.setattr(focus_reports, "MAX_REPORT_ROWS", 10)
    opened = OpenedShot()
    with opened.use(record, "") as shot:
        for name in ("one", "two"):
            shot.focus.add_point(None, name, FocusPoint(name, target=("/World/far",)))
        edits = shot.edits.history.present.text
    render = ReportedRender("r-1", "demo", "", None, 64, None, tuple(range(1, frames + 1)), f"1-{frames}")
    if fits:
        assert focus_reports.report_focus(opened, record, edits, render, "csv").count("\r\n") == 11
        return
    with pytest.raises(SettingsError, match="6 frames of 2 focus points") as refused:
        focus_reports.report_focus(opened, record, edits, render, "csv")
    assert (refused.value.code, refused.value.path) == ("report_too_long", "frames")
