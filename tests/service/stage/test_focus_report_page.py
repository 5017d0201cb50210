"""Focus reports as pages of HTML."""

from __future__ import annotations

import math
from html.parser import HTMLParser

import pytest

from service.models.focus_reports import REPORT_EXAMPLE, FocusReport
from service.stage.focus_report_page import Mark, Marks, write_report_page


class Cells(HTMLParser):
    """Reads the rows of all tables, and the names of all elements."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.elements: set[str] = set()
        self._is_cell = False
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.add(tag)
        if tag == "tr":
            self.rows.append([])
        self._is_cell = tag in ("td", "th")
        if self._is_cell:
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        self._is_cell = self._is_cell and tag not in ("td", "th")

    def handle_data(self, data: str) -> None:
        if self._is_cell:
            self.rows[-1][-1] += data


def report(**changes: object) -> FocusReport:
    """The example of the schema: one sample, of frame 24, whose point is softest in frame 31."""
    return FocusReport.model_validate(REPORT_EXAMPLE | changes)


def test_lens_and_points_are_in_tables() -> None:
    rows = Cells(write_report_page(report(), Marks())).rows
    assert ["lens", "Planar 50 mm f/1.4"] in rows
    assert ["f-number", "f/2"] in rows
    assert ["focus distance", "3.42 m (11 ft 3 in)"] in rows
    assert ["pip", "24", "24", "30-32", "frame 31: 0.031 mm, 0.6 px, in front of the focus"] in rows


@pytest.mark.parametrize(
    ("focus_m", "metres", "feet"),
    [
        (math.inf, "∞", "∞"),
        (0.9144, "0.91", "3 ft 0 in"),
        (0.9271, "0.93", "3 ft 0.5 in"),
        (6.0452, "6.05", "19 ft 10 in"),
    ],
)
def test_marks_have_metres_and_feet(focus_m: float, metres: str, feet: str) -> None:
    rows = Cells(write_report_page(report(), Marks((Mark(36.0, "focus distance", focus_m),), 1))).rows
    assert rows[-1] == ["36", "focus distance", metres, feet]


def test_names_of_a_shot_are_text() -> None:
    page = write_report_page(
        report(lensName="<script>alert(1)</script>", shot="<img src=x>"), Marks((Mark(1, "<b>", 1),), 1)
    )
    found = Cells(page)
    assert not found.elements & {"script", "img", "b"}
    assert ["lens", "<script>alert(1)</script>"] in found.rows


def test_a_page_needs_no_other_file() -> None:
    page = write_report_page(report(), Marks())
    assert "<svg" in page
    assert not {"link", "script", "img", "iframe"} & Cells(page).elements


def test_what_is_left_out_is_said() -> None:
    mark = Mark(1, "focus distance", 2)
    assert "The first 1 of 700 keys." in write_report_page(report(), Marks((mark,), 700))
    assert "The first" not in write_report_page(report(), Marks((mark,), 1))
