"""Focus report as a page of HTML that stands alone: lens data, chart, who is sharp when, and the marks of the pull."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from service.models.focus_reports import FocusReport, PointSummary, ReportSample, SoftestPoint

_FOOT_M = 0.3048
_STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; color: #222; max-width: 1080px; margin: 2em auto; padding: 0 1.5em; }
h1 { font-size: 1.5em; margin: 0; } h2 { font-size: 1.1em; margin: 1.8em 0 .5em; } p { margin: .4em 0; }
table { border-collapse: collapse; width: 100%; } th, td { text-align: left; padding: .3em .8em .3em 0; vertical-align: top; }
tr + tr > * { border-top: 1px solid #ddd; } thead th { border-bottom: 1px solid #888; font-weight: 600; }
.faint { color: #666; }
.soft { color: #b3331c; font-weight: 600; } .sharp { color: #1f7a3d; font-weight: 600; } svg { width: 100%; height: auto; }
@media print { body { margin: 0; max-width: none; } h2 { break-after: avoid; } tr, svg { break-inside: avoid; } }
"""


@dataclass(frozen=True)
class Mark:
    """A key that changes the focus.

    Attributes:
        time: USD time code.
        what: the value that is keyed, in words.
        focus_m: distance of the focus there; may be infinite.
    """

    time: float
    what: str
    focus_m: float


@dataclass(frozen=True)
class Marks:
    """Marks of a pull.

    Attributes:
        shown: those of the page, in order of time.
        count: number of all.
    """

    shown: tuple[Mark, ...] = ()
    count: int = 0


def write_report_page(report: FocusReport, marks: Marks) -> str:
    """Write a focus report as HTML, which needs no other file.

    Args:
        report: the report.
        marks: keys that change the focus.
    """
    title = f"Focus report of {report.shot}"
    parts = [
        f"<h1>{escape(title)}</h1>",
        f'<p class="faint">{escape(_subtitle(report))}</p>',
        _verdict(report),
        "<h2>Lens</h2>",
        _table([], _lens_rows(report)),
        "<h2>Pull</h2>",
        _chart(report),
        "<h2>Who is sharp when</h2>",
        _points(report),
        "<h2>Marks</h2>",
        _marks(marks),
    ]
    body = "\n".join(part for part in parts if part)
    head = f'<meta charset="utf-8">\n<title>{escape(title)}</title>\n<style>{_STYLE}</style>'
    return f'<!doctype html>\n<html lang="en">\n<head>\n{head}\n</head>\n<body>\n{body}\n</body>\n</html>\n'


def _subtitle(report: FocusReport) -> str:
    camera = report.camera or "framing camera"
    return f"{camera}, frames {report.frames}, {report.width} px wide, render {report.render}, edits {report.revision}"


def _verdict(report: FocusReport) -> str:
    soft, softest = report.summary.soft_frames, report.summary.softest
    if softest is None:
        return "<p>No focus point has to be sharp in these frames.</p>"
    if not soft:
        return f'<p class="sharp">All points that have to be sharp are sharp in all {report.count} frames.</p>'
    frames = f"{len(soft)} of {report.count} frames"
    return f'<p class="soft">In {frames} a point is soft that has to be sharp: {escape(_ranges(soft))}.</p>'


def _lens_rows(report: FocusReport) -> Iterable[tuple[str, str]]:
    samples = report.samples
    yield "lens", report.lens_name or "without a name"
    yield "focal length", _span([sample.focal_length_mm for sample in samples], "{:.4g} mm")
    yield "f-number", _span([sample.f_stop for sample in samples], "f/{:.3g}") if _has_iris(samples) else "pinhole"
    yield "T-stop", _span([_number(sample.t_stop) for sample in samples], "T {:.3g}") if _has_iris(samples) else "none"
    yield "focus distance", _distances([_number(sample.focus_distance_m) for sample in samples])
    yield "hyperfocal distance", _distances([_number(sample.hyperfocal_m) for sample in samples])
    yield "sharp up to a circle of", _span([sample.coc_limit_mm for sample in samples], "{:.3g} mm on the film")
    yield "focus", ", ".join(dict.fromkeys(sample.focus_mode for sample in samples))
    if any(sample.tilt_deg or sample.swing_deg for sample in samples):
        yield "tilt", _span([sample.tilt_deg for sample in samples], "{:.2f}°")
        yield "swing", _span([sample.swing_deg for sample in samples], "{:.2f}°")
    notes = dict.fromkeys(sample.note for sample in samples if sample.note)
    if notes:
        yield "notes", " ".join(notes)


def _has_iris(samples: Sequence[ReportSample]) -> bool:
    return any(sample.f_stop > 0 for sample in samples)


def _chart(report: FocusReport) -> str:
    from render.drawing.focus_chart import (  # matplotlib takes a second to import
        MOST_STRIPS,
        FocusTrack,
        PointTrack,
        draw_focus_chart,
    )

    samples = report.samples
    points = [
        PointTrack(
            name=point.name,
            depths_m=np.array([_depth(sample.points[index].depth_m) for sample in samples]),
            judged=np.array([sample.points[index].judged for sample in samples]),
            sharp=np.array([sample.points[index].sharp for sample in samples]),
        )
        for index, point in enumerate(report.summary.points)
    ]
    track = FocusTrack(
        frames=np.array([sample.frame for sample in samples]),
        focus_m=np.array([_number(sample.focus_distance_m) for sample in samples]),
        near_m=np.array([_number(sample.near_m) for sample in samples]),
        far_m=np.array([_number(sample.far_m) for sample in samples]),
        points=points,
    )
    drawing = draw_focus_chart(track, "svg").decode()
    return drawing[drawing.index("<svg") :] + _cut(min(len(points), MOST_STRIPS), len(points), "points have strips")


def _cut(shown: int, count: int, words: str) -> str:
    """Sentence about what is left out; empty where nothing is."""
    return f'<p class="faint">The first {shown} of {count} {words}.</p>' if shown < count else ""


def _points(report: FocusReport) -> str:
    if not report.summary.points:
        return "<p>The camera has no focus points.</p>"
    head = ["point", "has to be sharp in", "is sharp in", "is soft in", "softest"]
    return _table(head, [_point_row(report, index, point) for index, point in enumerate(report.summary.points)])


def _point_row(report: FocusReport, index: int, point: PointSummary) -> tuple[str, ...]:
    judged = [sample.frame for sample in report.samples if sample.points[index].judged]
    soft = set(point.soft_frames)
    sharp = [frame for frame in judged if frame not in soft]
    return point.name, _ranges(judged), _ranges(sharp), _ranges(point.soft_frames), _softest(point.softest)


def _softest(softest: SoftestPoint | None) -> str:
    if softest is None:
        return ""
    mm, px = _number(softest.signed_coc_mm), _number(softest.signed_coc_px)
    side = "in front of" if mm < 0 else "behind"
    return f"frame {softest.frame}: {abs(mm):.3f} mm, {abs(px):.1f} px, {side} the focus"


def _marks(marks: Marks) -> str:
    if not marks.shown:
        return "<p>Nothing that changes the focus has keys.</p>"
    rows = [(f"{mark.time:g}", mark.what, _metres(mark.focus_m), _feet(mark.focus_m)) for mark in marks.shown]
    return _table(["frame", "key", "focus, m", "focus, ft"], rows) + _cut(len(marks.shown), marks.count, "keys")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    columns = "".join(f'<th scope="col">{escape(name)}</th>' for name in head)
    top = f"<thead><tr>{columns}</tr></thead>" if head else ""
    body = "\n".join(_row(cells) for cells in rows)
    return f"<table>{top}<tbody>\n{body}\n</tbody></table>"


def _row(cells: Sequence[str]) -> str:
    first, *rest = cells
    others = "".join(f"<td>{escape(cell)}</td>" for cell in rest)
    return f'<tr><th scope="row">{escape(first)}</th>{others}</tr>'


def _number(distance: float | None) -> float:
    """The number of a field whose null is infinity."""
    return math.inf if distance is None else distance


def _depth(depth_m: float | None) -> float:
    """The depth of a point, NaN where it has none."""
    return math.nan if depth_m is None else depth_m


def _span(numbers: Sequence[float], words: str) -> str:
    least, most = words.format(min(numbers)), words.format(max(numbers))
    return least if least == most else f"{least} to {most}"


def _distances(distances_m: Sequence[float]) -> str:
    least, most = min(distances_m), max(distances_m)
    nearest = f"{_metres(least)} m ({_feet(least)})" if math.isfinite(least) else "∞"
    farthest = f"{_metres(most)} m ({_feet(most)})" if math.isfinite(most) else "∞"
    return nearest if nearest == farthest else f"{nearest} to {farthest}"


def _metres(distance_m: float) -> str:
    return f"{distance_m:.2f}" if math.isfinite(distance_m) else "∞"


def _feet(distance_m: float) -> str:
    """Feet and inches, to half an inch below 10 feet and to an inch above."""
    if not math.isfinite(distance_m):
        return "∞"
    step = 2 if distance_m < 10 * _FOOT_M else 1
    inches = round(distance_m / _FOOT_M * 12 * step) / step
    feet = int(inches // 12)
    return f"{feet} ft {inches - 12 * feet:g} in"


def _ranges(frames: Sequence[int]) -> str:
    """Frames in rising order as ranges, such as ``3-7, 9``; a dash for none."""
    if not frames:
        return "–"
    runs: list[list[int]] = []
    for frame in frames:
        if runs and frame == runs[-1][1] + 1:
            runs[-1][1] = frame
        else:
            runs.append([frame, frame])
    return ", ".join(f"{first}" if first == last else f"{first}-{last}" for first, last in runs)
