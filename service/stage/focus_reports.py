"""Function of the stage process that reports the focus in the frames of a render, as JSON, CSV or HTML.

The CSV has one row for each focus point of each frame under a header whose names end in their units, ``inf`` for infinity and an
empty cell for what does not exist; a frame of a camera without focus points is one row. Line ends are CR LF (RFC 4180).
"""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterator, Sequence

from render.errors import SettingsError
from render.shot import Shot
from render.shot.focus.report import ReportedFrame, ReportedPoint
from service.models.focus_reports import (
    MAX_REPORT_ROWS,
    FocusReport,
    PointSummary,
    ReportedRender,
    ReportFormat,
    ReportPoint,
    ReportSample,
    ReportSummary,
    SoftestPoint,
)
from service.stage.focus_report_page import Mark, Marks, write_report_page
from service.stage.opened import OpenedShot, stage_function
from service.stage.read_points import point_names
from service.storage.store import ShotRecord

MOST_MARKS = 500
"""Keys in a report of HTML."""
_LENS: dict[str, Callable[[ReportedFrame], object]] = {
    "frame": lambda frame: int(frame.time),
    "focus_distance_m": lambda frame: frame.readout.focus_distance_m,
    "f_stop": lambda frame: frame.readout.f_stop,
    "t_stop": lambda frame: frame.t_stop,
    "focal_length_mm": lambda frame: frame.readout.focal_length_mm,
    "near_m": lambda frame: frame.readout.near_m,
    "far_m": lambda frame: frame.readout.far_m,
    "hyperfocal_m": lambda frame: frame.readout.hyperfocal_m,
    "coc_limit_mm": lambda frame: frame.readout.coc_limit_mm,
    "tilt_deg": lambda frame: math.degrees(frame.readout.tilt_rad),
    "swing_deg": lambda frame: math.degrees(frame.readout.swing_rad),
    "focus_mode": lambda frame: frame.readout.focus_mode,
    "source": lambda frame: frame.readout.source,
    "note": lambda frame: frame.readout.note,
}
"""Values of a frame by their names in `ReportSample` and in CSV."""
_POINT: dict[str, Callable[[ReportedPoint], object]] = {
    "name": lambda point: point.placed.point.name,
    "enabled": lambda point: point.placed.point.enabled,
    "weight": lambda point: point.placed.point.weight,
    "kind": lambda point: point.placed.point.kind,
    "state": lambda point: point.placed.state,
    "depth_m": lambda point: point.placed.depth_m,
    "focus_distance_m": lambda point: point.placed.focus_distance_m,
    "signed_coc_mm": lambda point: point.signed_coc_mm,
    "signed_coc_px": lambda point: point.signed_coc_px,
    "sharp": lambda point: bool(point.placed.is_sharp),
    "visible_in_frame": lambda point: point.placed.visible_in_frame,
    "judged": lambda point: point.is_judged,
}
"""Values of a focus point by their names in `ReportPoint`, and in CSV after ``point_``."""


@stage_function
def report_focus(
    opened: OpenedShot, record: ShotRecord, edits: str, render: ReportedRender, format: ReportFormat
) -> str:
    """Report the focus in the frames of a render, as the text of a file.

    Args:
        opened: the open shots.
        record: the shot.
        edits: text of the edit layer that the render keeps.
        render: the render.
        format: of the file.

    Raises:
        SettingsError: the report would have too many rows.
        CameraError: it is no camera, or has impossible values.
    """
    with opened.use(record, edits) as shot:
        points = len(point_names(shot, render.camera))
        if points * len(render.frames) > MAX_REPORT_ROWS:
            raise SettingsError(
                f"{len(render.frames):,} frames of {points:,} focus points were requested; a report has {MAX_REPORT_ROWS:,} rows "
                "at most: ask for some of the frames",
                code="report_too_long",
                path="frames",
            )
        frames = shot.report_focus(
            render.camera, [float(frame) for frame in render.frames], render.width, render.height
        )
        marks = _marks(shot, render, frames[0].readout.camera) if format == "html" else Marks()
    match format:
        case "csv":
            return _to_csv(frames)
        case "html":
            return write_report_page(_report(render, frames), marks)
        case "json":
            return _report(render, frames).model_dump_json(by_alias=True)


def _marks(shot: Shot, render: ReportedRender, camera: str) -> Marks:
    """Return the keys between the first and the last frame that change the focus, `MOST_MARKS` at most."""
    if not camera:
        return Marks()
    keyed = [(key.time, "focus distance") for key in shot.camera.keys(camera, "focus_distance_m")]
    for name in point_names(shot, camera):
        keyed += [(key.time, f"weight of {name}: {key.value:g}") for key in shot.focus.keys(camera, name, "weight")]
        keyed += [
            (key.time, f"{name} {'on' if key.value else 'off'}") for key in shot.focus.keys(camera, name, "enabled")
        ]
    first, last = render.frames[0], render.frames[-1]
    keyed = sorted(key for key in keyed if first <= key[0] <= last)
    count, keyed = len(keyed), keyed[:MOST_MARKS]
    if not keyed:
        return Marks()
    times = sorted({time for time, _ in keyed})
    focus = {
        frame.time: frame.readout.focus_distance_m
        for frame in shot.report_focus(camera, times, render.width, render.height)
    }
    return Marks(tuple(Mark(time, what, focus[time]) for time, what in keyed), count)


def _to_csv(frames: Sequence[ReportedFrame]) -> str:
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow([*_LENS, *(f"point_{name}" for name in _POINT)])
    for frame in frames:
        lens = [_cell(value(frame)) for value in _LENS.values()]
        for point in frame.points:
            writer.writerow([*lens, *(_cell(value(point)) for value in _POINT.values())])
        if not frame.points:
            writer.writerow([*lens, *[""] * len(_POINT)])
    return text.getvalue()


def _cell(value: object) -> str:
    match value:
        case bool():
            return str(value).lower()
        case float():
            return "" if math.isnan(value) else repr(float(value))
        case _:
            return str(value)


def _report(render: ReportedRender, frames: Sequence[ReportedFrame]) -> FocusReport:
    return FocusReport(
        render=render.id,
        shot=render.shot,
        revision=render.revision,
        camera=frames[0].readout.camera or None,
        lens_name=frames[0].readout.lens_name,
        width=render.width,
        frames=render.range,
        count=len(frames),
        summary=_summary(frames),
        samples=[_sample(frame) for frame in frames],
    )


def _sample(frame: ReportedFrame) -> ReportSample:
    points = [
        ReportPoint.model_validate({name: value(point) for name, value in _POINT.items()}) for point in frame.points
    ]
    return ReportSample.model_validate({name: value(frame) for name, value in _LENS.items()} | {"points": points})


def _summary(frames: Sequence[ReportedFrame]) -> ReportSummary:
    names = [point.placed.point.name for point in frames[0].points]  # a camera has the same points at all times
    return ReportSummary(
        softest=_softest(_judged(frames)),
        soft_frames=[int(frame.time) for frame in frames if any(point.is_soft for point in frame.points)],
        points=[_point_summary(name, list(_judged(frames, index))) for index, name in enumerate(names)],
    )


def _judged(frames: Sequence[ReportedFrame], index: int | None = None) -> Iterator[tuple[int, ReportedPoint]]:
    """Yield the focus points that have to be sharp, with their frames; those of one index, where one is given."""
    for frame in frames:
        points = frame.points if index is None else frame.points[index : index + 1]
        yield from ((int(frame.time), point) for point in points if point.is_judged)


def _point_summary(name: str, judged: Sequence[tuple[int, ReportedPoint]]) -> PointSummary:
    return PointSummary(
        name=name,
        judged_count=len(judged),
        soft_frames=[frame for frame, point in judged if point.is_soft],
        softest=_softest(iter(judged)),
    )


def _softest(judged: Iterator[tuple[int, ReportedPoint]]) -> SoftestPoint | None:
    """Return the first of those with the largest circle of confusion; None where there are none."""
    found = max(judged, key=lambda one: abs(one[1].signed_coc_mm), default=None)
    if found is None:
        return None
    frame, point = found
    return SoftestPoint(
        frame=frame,
        point=point.placed.point.name,
        signed_coc_mm=point.signed_coc_mm,
        signed_coc_px=point.signed_coc_px,
        sharp=bool(point.placed.is_sharp),
    )
