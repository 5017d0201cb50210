"""Focus curves as files: everything in the curve is in the file, and infinity survives."""

import csv
import io
import json
import math

import numpy as np
import opentimelineio as otio
import pytest

from render.errors import SettingsError
from render.focus.files import FORMATS, Rates, curve_to_csv, curve_to_json, curve_to_text, read_curve
from tests.render.kits.focus_curves import curve, full_curve, same

ANY_RATES = Rates(25.0, 50.0)


def test_json_is_strict_and_complete():
    def refuse(constant):
        pytest.fail(f"{constant} is no JSON")

    data = json.loads(curve_to_json(curve()), parse_constant=refuse)
    assert (data["format"], data["version"], data["camera"]) == ("pullfocus.focusCurve", 2, "/World/cam")
    first, _, last = data["samples"]
    assert (first["frame"], first["timeCode"], first["seconds"]) == (1.0, 2.0, pytest.approx(1 / 24))
    assert first["focusDistanceM"] == 1.0
    assert first["sharp"] == ["hero"]
    assert first["points"] == [
        {"name": "hero", "state": "used", "depthM": 1.0, "weight": 1.0, "share": 1.0, "cocMm": 0.0}
    ]
    assert last["focusDistanceM"] is None
    assert last["farM"] is None
    assert last["points"][0]["depthM"] is None
    assert last["points"][0]["state"] == "lost"
    assert (last["source"], last["reason"]) == ("camera", "no focus point counts")
    assert (first["tiltDeg"], first["swingDeg"], first["limited"]) == (0.0, 0.0, False)


def test_csv_reads_back_as_the_same_numbers():
    rows = list(csv.DictReader(io.StringIO(curve_to_csv(curve()), newline="")))
    assert [float(row["focus_distance_m"]) for row in rows] == [1.0, 2.0, math.inf]
    assert [float(row["frame"]) for row in rows] == [1.0, 2.0, 3.0]
    assert [row["hero.depth_m"] for row in rows] == ["1.0", "2.0", ""]
    assert [row["hero.state"] for row in rows] == ["used", "used", "lost"]
    assert [row["sharp"] for row in rows] == ["hero", "hero", ""]


def test_columns_of_another_length_are_refused():
    with pytest.raises(SettingsError, match="3 frames"):
        curve(f_stop=np.array([2.0]))


@pytest.mark.parametrize("times", [[2.0, 2.0, 3.0], [3.0, 2.0, 1.0], [1.0, math.nan, 2.0]])
def test_time_rises(times):
    with pytest.raises(SettingsError, match="rise"):
        curve(time_codes=np.array(times))


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize("made", [curve(), full_curve(), full_curve(1), full_curve(7, 60.0)])
def test_every_file_reads_back_as_the_same_curve(format, made):
    # A unit in the last place: OpenTimelineIO reads numbers so, and angles are turned to degrees and back.
    read = read_curve(curve_to_text(made, format).encode(), ANY_RATES)
    same(made, read.curve, rel=1e-14, header=format != "csv")
    assert (read.findings, read.on_shot_time) == ((), True)
    assert read.given == {"focus_distance_m", "f_stop", "focal_length_mm", "tilt_rad", "swing_rad"}


@pytest.mark.parametrize("format", FORMATS)
def test_what_is_not_known_stays_unknown(format):
    unknown = np.full(3, math.nan)
    made = curve(near_m=unknown, far_m=unknown, hyperfocal_m=unknown, coc_limit_mm=unknown)
    read = read_curve(curve_to_text(made, format), ANY_RATES)
    same(made, read.curve, header=format != "csv")
    assert read.curve.sharp_points(0) == ()


@pytest.mark.parametrize("format", FORMATS)
def test_a_pinhole_focused_at_infinity_comes_back(format):
    made = curve(f_stop=np.zeros(3), focus_distance_m=np.full(3, math.inf))
    same(made, read_curve(curve_to_text(made, format), ANY_RATES).curve, header=format != "csv")


def test_the_first_version_of_the_json_is_read():
    data = json.loads(curve_to_json(curve()))
    data["version"] = 1
    del data["lens"], data["gateMm"]
    for sample in data["samples"]:
        del sample["tiltDeg"], sample["swingDeg"], sample["limited"]
    read = read_curve(json.dumps(data), ANY_RATES)
    same(curve(), read.curve)
    assert "tilt_rad" not in read.given


def test_a_timeline_says_who_is_sharp_when():
    timeline = otio.core.deserialize_json_from_string(curve_to_text(curve(), "otio"))
    [clip] = timeline.find_clips()
    assert (clip.name, clip.source_range.start_time.value, clip.source_range.duration.value) == ("cam", 1, 3)
    assert clip.source_range.start_time.rate == 24
    told = [(m.name, m.marked_range.start_time.value, m.marked_range.duration.value, m.color) for m in clip.markers]
    assert told == [("sharp: hero", 1, 2, "GREEN"), ("nothing sharp", 3, 1, "YELLOW")]
    assert list(clip.markers[0].metadata["pullfocus"]["focusDistanceM"]) == [1.0, 2.0]
    assert list(clip.markers[1].metadata["pullfocus"]["focusDistanceM"]) == [None, None]


def test_a_marker_shows_where_the_lens_could_not():
    timeline = otio.core.deserialize_json_from_string(
        curve_to_text(curve(limited=np.array([False, True, False])), "otio")
    )
    [clip] = timeline.find_clips()
    assert [marker.color for marker in clip.markers] == ["GREEN", "RED", "YELLOW"]


def test_half_frames_last_until_the_next():
    halves = curve(time_codes=np.array([2.0, 3.0, 4.0]))
    [clip] = otio.core.deserialize_json_from_string(curve_to_text(halves, "otio")).find_clips()
    assert clip.source_range.duration.value == 2.0
    assert [m.marked_range.duration.value for m in clip.markers] == [1.0, 1.0]
