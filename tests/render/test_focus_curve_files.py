"""Focus curves as files: everything in the curve is in the file, and infinity survives."""

import csv
import io
import json
import math

import numpy as np
import pytest

from render.errors import SettingsError
from render.focus import FocusCurve, PointTrack, curve_to_csv, curve_to_json


def curve(**changes) -> FocusCurve:
    """Three frames of a rack from near to infinity, on a stage with two time codes a frame."""
    fields = {
        "camera": "/World/cam",
        "frames_per_second": 24.0,
        "time_codes_per_second": 48.0,
        "time_codes": np.array([2.0, 4.0, 6.0]),
        "focus_distance_m": np.array([1.0, 2.0, math.inf]),
        "f_stop": np.array([2.0, 2.0, 2.0]),
        "focal_length_mm": np.array([50.0, 50.0, 50.0]),
        "near_m": np.array([0.98, 1.9, 43.0]),
        "far_m": np.array([1.02, 2.1, math.inf]),
        "hyperfocal_m": np.array([43.0, 43.0, 43.0]),
        "coc_limit_mm": np.array([0.029, 0.029, 0.029]),
        "sources": ("points", "points", "camera"),
        "reasons": ("focused by hero", "focused by hero", "no focus point counts"),
        "points": (
            PointTrack(
                name="hero",
                depth_m=np.array([1.0, 2.0, math.nan]),
                weight=np.array([1.0, 1.0, 1.0]),
                share=np.array([1.0, 1.0, 0.0]),
                coc_mm=np.array([0.0, 0.01, math.nan]),
                states=("used", "used", "lost"),
            ),
        ),
    }
    return FocusCurve(**{**fields, **changes})


def test_json_is_strict_and_complete():
    def refuse(constant):
        pytest.fail(f"{constant} is no JSON")

    data = json.loads(curve_to_json(curve()), parse_constant=refuse)
    assert (data["format"], data["version"], data["camera"]) == ("pullfocus.focusCurve", 1, "/World/cam")
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
