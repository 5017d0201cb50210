"""OpenTrackIO: what we write has the protocol's own names and units, and what others write is read as they mean it."""

import json
import math
import re

import numpy as np
import pytest

from render.errors import InputError
from render.focus.files import Rates, curve_to_text, read_curve
from tests.render.kits.focus_curves import curve, full_curve, same_numbers

RATES = Rates(24.0, 24.0)
RATIO = {"num", "denom"}
NAMES = {
    "static": {
        "duration": RATIO,
        "camera": {"captureFrameRate": RATIO, "label": None, "activeSensorPhysicalDimensions": {"width", "height"}},
        "lens": {"model": None, "nominalFocalLength": None},
    },
    "timing": {
        "mode": None,
        "sampleRate": RATIO,
        "sequenceNumber": None,
        "timecode": {
            "hours": None,
            "minutes": None,
            "seconds": None,
            "frames": None,
            "frameRate": RATIO,
            "dropFrame": None,
        },
    },
    "lens": {"fStop": None, "pinholeFocalLength": None, "focusDistance": None},
    "protocol": {"name", "version"},
    "sampleId": None,
    "sourceId": None,
    "sourceNumber": None,
    "custom": None,
}
"""Those names of the public schema of version 1.0.1 that a focus curve can fill; the schema refuses all it does not know."""


def assert_named(data: dict, names, where: str = "") -> None:
    for name, value in data.items():
        assert name in names, f"{where}{name}"
        if isinstance(names, dict) and names[name] is not None:
            assert_named(value, names[name], f"{where}{name}.")


def samples(**changes) -> list[dict]:
    return json.loads(curve_to_text(curve(**changes), "opentrackio"))


def others(distances, times, **timing) -> str:
    """Samples as a tracker on a set writes them: no frame numbers of a shot, and no part of ours."""
    made = [
        {
            "protocol": {"name": "OpenTrackIO", "version": [1, 0, 0]},
            "timing": {"mode": "external", "sampleRate": {"num": 24000, "denom": 1001}, **time} | timing,
            "lens": {"focusDistance": distance, "pinholeFocalLength": 24.305, "encoders": {"focus": 0.1}},
        }
        for distance, time in zip(distances, times, strict=True)
    ]
    return json.dumps(made)


def timecode(seconds: int, frames: int, hours: int = 1, minutes: int = 2) -> dict:
    rate = {"num": 24000, "denom": 1001}
    return {"timecode": {"hours": hours, "minutes": minutes, "seconds": seconds, "frames": frames, "frameRate": rate}}


def test_samples_have_the_names_of_the_protocol():
    for sample in (*samples(), *json.loads(curve_to_text(full_curve(), "opentrackio"))):
        assert_named(sample, NAMES)
        assert sample["protocol"] == {"name": "OpenTrackIO", "version": [1, 0, 1]}
        for name in ("sampleId", "sourceId"):
            assert re.fullmatch(r"urn:uuid:[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}", sample[name])
    ids = [sample["sampleId"] for sample in samples()]
    assert len(set(ids)) == 3
    assert ids == [sample["sampleId"] for sample in samples()], "the same curve has the same identifiers"


def test_units_are_metres_and_millimetres():
    first, second, last = samples()
    assert first["lens"] == {"focusDistance": 1.0, "fStop": 2.0, "pinholeFocalLength": 50.0}
    assert last["lens"]["focusDistance"] == 1e5
    assert last["custom"]["pullfocus"]["focusDistanceM"] is None
    assert second["timing"]["timecode"]["frames"] == 2
    assert "static" in first
    assert "static" not in second


def test_the_static_part_tells_camera_and_lens():
    static = json.loads(curve_to_text(full_curve(), "opentrackio"))[0]["static"]
    assert static["camera"]["captureFrameRate"] == {"num": 24000, "denom": 1001}
    assert static["camera"]["activeSensorPhysicalDimensions"] == {"width": 24.89, "height": 18.66}
    assert static["duration"] == {"num": 1001, "denom": 500}, "48 frames at 23.976 are 2.002 s"
    assert static["lens"] == {"model": "Summicron 50", "nominalFocalLength": 47.3}
    zoomed = curve(focal_length_mm=np.array([40.0, 50.0, 60.0]))
    assert json.loads(curve_to_text(zoomed, "opentrackio"))[0]["static"]["lens"] == {}, "a zoom has no nominal one"


def test_a_pinhole_has_no_f_number():
    assert "fStop" not in samples(f_stop=np.zeros(3))[0]["lens"]


@pytest.mark.parametrize("strung", ["array", "lines", "object"])
def test_samples_are_read_however_they_are_strung_together(strung):
    made = samples()
    text = {
        "array": json.dumps(made),
        "lines": "\n".join(json.dumps(sample) for sample in made) + "\n",
        "object": json.dumps({"samples": made}),
    }[strung]
    same_numbers(curve(), read_curve(text, RATES).curve)


def test_what_another_tool_changed_wins():
    made = samples()
    made[1]["lens"]["focusDistance"] = 3.0
    read = read_curve(json.dumps(made), RATES).curve
    assert read.focus_distance_m.tolist() == [1.0, 3.0, math.inf]
    assert np.isnan(read.near_m).tolist() == [False, True, False], "its depth of field is not known any more"


def test_a_trackers_samples_run_by_timecode():
    read = read_curve(others([2.0, 2.5, 3.0], [timecode(59, 22), timecode(59, 23), timecode(0, 0, minutes=3)]), RATES)
    assert read.given == {"focus_distance_m", "focal_length_mm"}
    assert not read.on_shot_time
    assert np.diff(read.curve.frames) == pytest.approx([1, 1])
    assert read.curve.frames[0] == pytest.approx((62 * 60 + 59) * 24 + 22)
    assert read.curve.frames_per_second == pytest.approx(24000 / 1001)
    assert np.isnan(read.curve.f_stop).all()


def test_timecode_goes_on_over_midnight():
    times = [timecode(59, 23, hours=23, minutes=59), timecode(0, 0, hours=0, minutes=0)]
    assert np.diff(read_curve(others([2.0, 2.5], times), RATES).curve.frames) == pytest.approx([1])


def test_dropped_frames_are_numbers_alone():
    rate = {"num": 30000, "denom": 1001}
    times = [
        {"timecode": {"hours": 0, "minutes": m, "seconds": s, "frames": f, "frameRate": rate, "dropFrame": True}}
        for m, s, f in ((0, 59, 28), (0, 59, 29), (1, 0, 2), (1, 0, 3))
    ]
    read = read_curve(others([2.0, 2.1, 2.2, 2.3], times, sampleRate=rate), RATES)
    assert np.diff(read.curve.frames) == pytest.approx([1, 1, 1])


def test_a_tracker_faster_than_timecode_runs_by_its_timestamps():
    stamp = [
        {"sampleTimestamp": {"seconds": 1718806554, "nanoseconds": n * 8_333_333}, **timecode(1, n // 5)}
        for n in range(20)
    ]
    read = read_curve(others(np.linspace(2, 3, 20).tolist(), stamp, sampleRate={"num": 120, "denom": 1}), RATES)
    assert np.diff(read.curve.seconds) == pytest.approx(np.full(19, 1 / 120), rel=1e-4)


def test_older_names_are_read():
    old = timecode(0, 1)["timecode"]
    old["format"] = {"frameRate": old.pop("frameRate")}
    text = others([2.0], [{"timecode": old}]).replace("pinholeFocalLength", "focalLength")
    read = read_curve(text, RATES).curve
    assert read.focal_length_mm.tolist() == [24.305]
    assert read.frames[0] == pytest.approx((62 * 60) * 24 + 1)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("[]", "no samples"),
        ('[{"lens": {"focusDistance": 2}}]', "protocol"),
        ('[{"protocol": {"name": "OpenTrackIO", "version": [1, 0, 1]}, "lens": {"focusDistance": 2}}]', "time"),
        (others([None], [timecode(0, 1)]), "sample 1"),
        (others(["far"], [timecode(0, 1)]), "lens.focusDistance must be a number, but it is 'far'"),
        (others([0.0], [timecode(0, 1)]), "above 0"),
        (others([0.02], [timecode(0, 1)]), "metres"),
        (others([2.0], [timecode(0, 1)]).replace("2.0", "NaN"), "NaN"),
        ('{"protocol": {"name": "OpenTrackIO"}', "JSON"),
    ],
)
def test_an_unreadable_file_is_reported(text, told):
    with pytest.raises(InputError, match=re.escape(told)):
        read_curve(text, RATES, format="opentrackio")
