"""Curves that others wrote: less of them, in other units, with holes in them. What cannot be used is named, never passed over."""

import contextlib
import json
import math
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from render.errors import InputError, SettingsError
from render.focus.files import Rates, curve_to_json, curve_to_text, read_curve, retime
from tests.render.kits.focus_curves import curve

RATES = Rates(24.0, 24.0)


def table(*rows: str, header: str = "frame,focus_distance_m") -> str:
    return "\n".join([header, *rows]) + "\n"


def messages(read) -> str:
    return "\n".join(finding.message for finding in read.findings)


def test_frames_and_distances_are_enough():
    read = read_curve(table("1,2.5", "2,3", "3,inf"), RATES)
    assert read.curve.frames.tolist() == [1, 2, 3]
    assert read.curve.focus_distance_m.tolist() == [2.5, 3, math.inf]
    assert (read.given, read.findings) == ({"focus_distance_m"}, ())
    assert np.isnan(read.curve.f_stop).all()


@pytest.mark.parametrize(
    ("header", "row", "distance_m"),
    [
        ("frame,focus_distance_cm", "1,250", 2.5),
        ("Frame, Focus Distance (ft)", "1, 10", 3.048),
        ("FRAME;focus_distance_mm", "1;2500,5", 2.5005),
        ("frame\tfocus_distance_in\r", "1\t100\r", 2.54),
        ("\ufeffseconds,focus_distance_m", "0.5,2", 2.0),
        ('time_code,"focus distance, m"', "12,2", 2.0),
    ],
)
def test_units_are_named_by_the_column(header, row, distance_m):
    read = read_curve(table(row, header=header).encode(), RATES)
    assert read.curve.focus_distance_m == pytest.approx([distance_m])


@pytest.mark.parametrize("header", ["frame,focus_distance", "frame,focus_distance_furlong", "frame,Focus Distance"])
def test_a_distance_without_a_known_unit_is_refused(header):
    with pytest.raises(InputError, match="focus_distance_m, focus_distance_cm") as caught:
        read_curve(table("1,2", header=header), RATES)
    assert caught.value.code == "bad_units"


def test_angles_come_in_degrees_or_radians():
    read = read_curve(table("1,2,90e-1,0.1", header="frame,focus_distance_m,tilt_deg,swing_rad"), RATES)
    assert (read.curve.tilt_rad[0], read.curve.swing_rad[0]) == pytest.approx((math.radians(9), 0.1))
    assert read.given == {"focus_distance_m", "tilt_rad", "swing_rad"}


def test_unknown_columns_are_named():
    read = read_curve(table("1,2,5,6", header="frame,focus_distance_m,iso,pan"), RATES)
    assert messages(read) == "columns that are not used: iso, pan"


BROKEN = {
    "2,": "row 3 cannot be used: focus_distance_m must be a number, but it is empty",
    "2,near": "row 3 cannot be used: focus_distance_m must be a number, but it is 'near'",
    "2,nan": "row 3 cannot be used: focus_distance_m must be above 0, or infinite, but it is nan",
    "2,-3": "row 3 cannot be used: focus_distance_m must be above 0, or infinite, but it is -3",
    "2,0": "row 3 cannot be used: focus_distance_m must be above 0, or infinite, but it is 0",
    "2": "row 3 cannot be used: it has 1 cells, but the header has 2",
    "2,3,4": "row 3 cannot be used: it has 3 cells, but the header has 2",
    "two,3": "row 3 cannot be used: frame must be a number, but it is 'two'",
    "1,3": "row 3 cannot be used: its time does not come after that of the row before",
    "nan,3": "row 3 cannot be used: frame must be finite, but it is nan",
}


@pytest.mark.parametrize(("row", "told"), BROKEN.items())
def test_a_broken_row_is_refused_by_its_number(row, told):
    with pytest.raises(InputError, match=re.escape(told)) as caught:
        read_curve(table("1,2", row, "3,6"), RATES)
    assert caught.value.code == "curve_gaps"


@pytest.mark.parametrize(("row", "told"), BROKEN.items())
@pytest.mark.parametrize(("gaps", "distance_m"), [("hold", 2.0), ("interpolate", 3.0)])
def test_a_broken_row_is_held_or_interpolated_on_request(row, told, gaps, distance_m):
    read = read_curve(table("1,2", row, "3,6", "4,6", "5,6"), RATES, gaps=gaps)
    assert told in messages(read)
    assert read.curve.frames.tolist() == [1, 2, 3, 4, 5]
    # 3 m is the middle between 2 m and 6 m in inverse distance
    assert read.curve.focus_distance_m == pytest.approx([2, distance_m, 6, 6, 6])
    assert ["between" in reason for reason in read.curve.reasons] == [False, True, False, False, False]


def test_missing_frames_are_named():
    text = table(*(f"{frame},2" for frame in (1, 2, 3, 7, 8, 12)))
    with pytest.raises(InputError, match=re.escape("no row for frames 4 to 6; the CSV has no row for frames 9 to 11")):
        read_curve(text, RATES)
    read = read_curve(text, RATES, gaps="hold")
    assert read.curve.frames.tolist() == list(range(1, 13))
    assert [(finding.code, finding.place) for finding in read.findings] == [
        ("gap", "frames 4 to 6"),
        ("gap", "frames 9 to 11"),
    ]


def test_every_second_frame_is_no_gap():
    read = read_curve(table("1,2", "3,2", "5,2", "7,2"), RATES)
    assert (read.curve.frames.tolist(), read.findings) == ([1, 3, 5, 7], ())


def test_before_the_first_and_behind_the_last_the_nearest_holds():
    for gaps in ("hold", "interpolate"):
        read = read_curve(table("1,x", "2,4", "3,8", "4,x"), RATES, gaps=gaps)
        assert read.curve.focus_distance_m.tolist() == [4, 4, 8, 8]
        assert [finding.place for finding in read.findings] == ["row 2", "row 5"]


def test_a_gap_before_infinity_goes_there():
    read = read_curve(table("1,2", "2,x", "3,inf"), RATES, gaps="interpolate")
    assert read.curve.focus_distance_m.tolist() == [2, 4, math.inf]


def test_in_a_gap_nothing_is_known_of_the_points():
    data = json.loads(curve_to_json(curve()))
    data["samples"][1]["focusDistanceM"] = "?"
    read = read_curve(json.dumps(data), RATES, gaps="interpolate")
    assert "sample 2" in messages(read)
    assert read.curve.points[0].states == ("used", "lost", "lost")
    assert np.isnan(read.curve.near_m).tolist() == [False, True, False]
    assert read.curve.sources == ("points", "camera", "camera")


def test_millimetres_in_place_of_metres_are_doubted():
    read = read_curve(table("1,2500", "2,2600", "3,2700"), RATES)
    assert "are they in metres" in messages(read)
    with pytest.raises(InputError, match="within the focal length of 50 mm: is it in metres"):
        read_curve(table("1,0.025,50", header="frame,focus_distance_m,focal_length_mm"), RATES)


def test_too_many_missing_frames_are_a_slip():
    with pytest.raises(InputError, match="100,000"):
        read_curve(table("1,2", "2,2", "3,2", "1e9,2"), RATES, gaps="hold")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("", "empty"),
        ("frame,focus_distance_m\n", "no rows"),
        ("focus_distance_m\n2\n", "column of time"),
        ("frame,f_stop\n1,2\n", "focus_distance_m"),
        ("frame,focus_distance_m\n1,?\n", "no row that can be used; row 2"),
        (b"\xff\xfe\x00", "UTF-8"),
        ('frame,focus_distance_m\n1,"2\n', "line"),
        ("{", "JSON"),
        ("[1]", "protocol"),
        ('{"format": "pullfocus.focusCurve", "version": 3}', "version 3"),
        ('{"format": "pullfocus.focusCurve", "version": 2, "samples": 5}', "samples"),
        ('{"format": "pullfocus.focusCurve", "version": 2, "samples": []}', "framesPerSecond"),
        ('{"OTIO_SCHEMA": "Clip.2", "metadata": {}}', "no clip"),
        ('{"OTIO_SCHEMA": "Gap.1"', "JSON"),
        ('{"OTIO_SCHEMA": "Clip.2", "metadata": {"pullfocus": {"focusCurve": {"version": 1}}}}', "format"),
        ('{"OTIO_SCHEMA": "Timeline.1", "metadata": {"pullfocus": 5}}', "no clip"),
        ('{"OTIO_SCHEMA": "Clip.2", "metadata": {"pullfocus": 5}}', "no clip"),
        ("[" * 100_000, "JSON"),
    ],
)
def test_a_file_that_is_no_curve_is_reported_in_one_sentence(content, told):
    with pytest.raises(InputError, match=re.escape(told)) as caught:
        read_curve(content, RATES)
    assert "\n" not in caught.value.detail


def test_unknown_words_are_refused():
    with pytest.raises(SettingsError, match="refuse, hold, interpolate"):
        read_curve(table("1,2"), RATES, gaps="guess")
    with pytest.raises(SettingsError, match="json, csv, otio, opentrackio"):
        read_curve(table("1,2"), RATES, format="pdf")
    with pytest.raises(SettingsError, match="json, csv, otio, opentrackio"):
        curve_to_text(curve(), "pdf")


def test_a_csv_whose_rate_is_near_zero_is_no_fault_of_the_program():
    header = "frame,time_code,seconds,focus_distance_m"
    content = table("0,0,0,3", "1,1,1e300,3", header=header)
    with contextlib.suppress(InputError):
        assert np.isfinite(read_curve(content, RATES, gaps="hold").curve.focus_distance_m).all()


def test_seconds_are_kept_where_the_shot_has_another_rate():
    read = retime(read_curve(curve_to_json(curve()), RATES), Rates(25.0, 25.0))
    assert read.curve.seconds == pytest.approx(curve().seconds)
    assert "24 frames in a second and the shot 25" in messages(read)
    moved = retime(read, Rates(25.0, 25.0), first_time_code=101.0)
    assert moved.curve.time_codes == pytest.approx([101, 101 + 25 / 24, 101 + 50 / 24])
    same = retime(read_curve(curve_to_json(curve()), RATES), Rates(24.0, 48.0))
    assert (same.curve.time_codes.tolist(), same.findings) == ([2, 4, 6], ())


@given(st.text(max_size=300) | st.binary(max_size=300))
def test_any_content_is_read_or_refused(content):
    with contextlib.suppress(InputError):
        read_curve(content, RATES, gaps="hold")


@given(
    st.lists(st.sampled_from(["1", "2.5", "inf", "nan", "", "x", "-1", "1e400", "frame", '"']), min_size=3, max_size=3),
    st.sampled_from(["refuse", "hold", "interpolate"]),
)
def test_any_cells_make_a_curve_or_a_sentence(cells, gaps):
    content = table("1,2,3", ",".join(cells), "9,4,5", header="frame,focus_distance_m,f_stop")
    with contextlib.suppress(InputError):
        read = read_curve(content, RATES, gaps=gaps)
        assert (read.curve.focus_distance_m > 0).all()
        assert np.isfinite(read.curve.f_stop).all()
        assert gaps != "refuse" or read.findings == ()
