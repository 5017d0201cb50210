"""Read focus curves of other tools in the time of a shot. `render.shot.focus.curve_layer` authors them on a camera."""

from __future__ import annotations

from dataclasses import replace

from pxr import Usd

from render.focus.files import CurveFinding, CurveFormat, Gaps, Rates, ReadCurve, read_curve, retime
from render.stage import frame_range


def read_for_shot(
    stage: Usd.Stage,
    content: bytes | str,
    *,
    format: CurveFormat | None = None,
    gaps: Gaps = "refuse",
    first_frame: float | None = None,
) -> ReadCurve:
    """Read a focus curve in the time of a shot.

    A file that counts frames, time codes or seconds keeps these. One with a clock of its own, such as timecode, begins at the
    first frame of the shot.

    Args:
        stage: the shot.
        content: of the file.
        format: of the file; None detects it.
        gaps: whether rows that are missing or cannot be used are refused, held or interpolated.
        first_frame: time code of the file's first frame; None as described above.

    Raises:
        InputError: the file cannot be read, or has gaps and these are refused.
        SettingsError: ``format`` or ``gaps`` is unknown.
    """
    rates = Rates(stage.GetFramesPerSecond(), stage.GetTimeCodesPerSecond())
    read = read_curve(content, rates, format=format, gaps=gaps)
    if first_frame is None and not read.on_shot_time:
        first_frame = frame_range(stage).start
        message = f"the file's clock is not the shot's: its first sample is put at time code {first_frame:g}"
        read = replace(read, findings=(*read.findings, CurveFinding("other_clock", "", message)))
    return retime(read, rates, first_frame)
