"""Curves of other tools on a camera of a shot: as a layer that any USD tool reads, and as an edit that can be undone."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd

from render.errors import InputError, SettingsError
from render.focus.files import FORMATS, curve_to_text
from render.shot import Shot
from render.shot.focus.curve_import import read_for_shot
from render.shot.focus.curve_layer import curve_layer
from tests.render.kits.cli_shots import Command
from tests.render.kits.focus_curves import full_curve
from tests.render.kits.focus_shot import CAMERA, FAR, FRAMES, Units, open_bare, write_shot
from usd_schemas import FocusPoint
from usd_schemas.units import metres_from_units, mm_from_tenths

ON_FAR = FocusPoint("far", target=(FAR,), face=0, fan_triangle=0, barycentric=(0.5, 0.0, 0.5))
RACK = "frame,focus_distance_m,f_stop,focal_length_mm\n" + "".join(
    f"{frame},{1 / np.interp(frame, (1, 24), (1 / 2, 1 / 9)):.6f},{np.interp(frame, (1, 24), (2, 4)):.6f},35\n"
    for frame in FRAMES
)


@pytest.fixture
def pullfocus(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write_shot(tmp_path / "shot.usda")


def over(path: Path, layer: str) -> Usd.Stage:
    """The shot with a layer over it, as any USD tool composes it."""
    strong, root = Sdf.Layer.CreateAnonymous("over.usda"), Sdf.Layer.CreateAnonymous("root.usda")
    assert strong.ImportFromString(layer)
    root.timeCodesPerSecond = open_bare(path).GetTimeCodesPerSecond()
    root.subLayerPaths = [strong.identifier, str(path)]
    stage = Usd.Stage.Open(root)
    stage.keep = strong
    return stage


@pytest.mark.parametrize("baked", [False, True])
@pytest.mark.parametrize("units", [Units(), Units(0.01, "Z", 48.0)])
def test_an_imported_layer_gives_any_usd_tool_the_curve(tmp_path, units, baked, pullfocus):
    path = write_shot(tmp_path / "shot.usda", units)
    source, out = tmp_path / "rack.csv", tmp_path / "pulled.usda"
    source.write_text(RACK)
    ended = pullfocus("focus-curve", path, "--import", source, "--out", out, *(["--baked"] if baked else []))
    assert (ended.status, ended.out) == (0, ""), ended.err
    stage, shot = over(path, out.read_text()), open_bare(path)
    camera = stage.GetPrimAtPath(CAMERA)
    rows = np.array([line.split(",") for line in RACK.splitlines()[1:]], float)
    for frame, distance_m, f_stop, focal_length_mm in rows:
        time = frame * units.per_second / 24
        focus, stop, length = (camera.GetAttribute(n).Get(time) for n in ("focusDistance", "fStop", "focalLength"))
        assert metres_from_units(focus, shot) == pytest.approx(distance_m, rel=1e-6)
        assert stop == pytest.approx(f_stop, rel=1e-6)
        assert mm_from_tenths(length, shot) == pytest.approx(focal_length_mm, rel=1e-6)
    for name in ("focusDistance", "fStop", "focalLength"):
        attribute = camera.GetAttribute(name)
        assert (attribute.GetNumTimeSamples() > 0, attribute.HasSpline()) == (baked, not baked)
    assert not camera.GetAttribute("tiltShift:tilt").HasAuthoredValue()


@pytest.mark.parametrize("format", FORMATS)
def test_what_the_shot_exports_it_imports(format, path, tmp_path, pullfocus):
    solved = Shot.open(path)
    solved.focus.add_point(CAMERA, "far", ON_FAR)
    curve = solved.focus.curve(CAMERA, FRAMES)
    source = tmp_path / f"focus.{format}"
    source.write_text(curve_to_text(curve, format))
    layer = pullfocus("focus-curve", path, "--import", source).out
    stage = over(path, layer)
    focus = stage.GetPrimAtPath(CAMERA).GetAttribute("focusDistance")
    assert [focus.Get(frame) for frame in FRAMES] == pytest.approx(curve.focus_distance_m.tolist(), rel=1e-6)


def test_an_import_can_become_another_file(path, tmp_path, pullfocus):
    source = tmp_path / "rack.csv"
    source.write_text(RACK)
    samples = json.loads(pullfocus("focus-curve", path, "--import", source, "--format", "opentrackio").out)
    assert len(samples) == 24
    assert samples[0]["lens"] == {"fStop": 2.0, "pinholeFocalLength": 35.0, "focusDistance": 2.0}


def test_gaps_are_filled_on_request_and_reported(path, tmp_path, pullfocus):
    source = tmp_path / "holes.csv"
    source.write_text("frame,focus_distance_m\n1,2\n2,?\n3,6\n4,6\n7,6\n")
    ended = pullfocus("focus-curve", path, "--import", source, "--gaps", "interpolate", "--format", "json")
    assert ended.status == 0
    for told in ("row 3 cannot be used", "no row for frames 5 to 6", "interpolated"):
        assert told in ended.err
    curve = json.loads(ended.out)
    assert [sample["focusDistanceM"] for sample in curve["samples"]] == pytest.approx([2, 3, 6, 6, 6, 6, 6])


def test_the_first_frame_can_be_put_anywhere(path, tmp_path, pullfocus):
    source = tmp_path / "rack.csv"
    source.write_text(RACK)
    text = pullfocus("focus-curve", path, "--import", source, "--first-frame", "101", "--format", "json").out
    assert [sample["frame"] for sample in json.loads(text)["samples"]][:2] == [101, 102]


def test_a_trackers_clock_begins_where_the_shot_does(path):
    shot = Shot.open(path)
    rate = {"num": 24, "denom": 1}
    samples = [
        {
            "protocol": {"name": "OpenTrackIO", "version": [1, 0, 1]},
            "timing": {"timecode": {"hours": 9, "minutes": 41, "seconds": 0, "frames": n, "frameRate": rate}},
            "lens": {"focusDistance": 2.0 + n},
        }
        for n in range(3)
    ]
    read = read_for_shot(shot.stage, json.dumps(samples))
    assert read.curve.time_codes == pytest.approx([1, 2, 3])
    assert "time code 1" in read.findings[0].message


@pytest.mark.parametrize("baked", [False, True])
def test_an_imported_curve_is_an_edit(path, baked):
    shot = Shot.open(path)
    shot.focus.add_point(CAMERA, "far", ON_FAR)
    before = shot.edits.export()
    shot.focus.import_curve(CAMERA, read_for_shot(shot.stage, RACK), baked=baked)
    readout = shot.focus.read(CAMERA, 24)
    assert (readout.focus_mode, readout.source) == ("manual", "camera")
    assert (readout.focus_distance_m, readout.f_stop) == (pytest.approx(9, rel=1e-6), pytest.approx(4))
    assert readout.focal_length_mm == pytest.approx(35)
    shot.edits.undo()
    assert shot.edits.export() == before
    assert shot.focus.read(CAMERA, 24).source == "points"


def test_samples_and_splines_take_each_others_place(path):
    shot = Shot.open(path)
    read = read_for_shot(shot.stage, RACK)
    focus = shot.stage.GetPrimAtPath(CAMERA).GetAttribute("focusDistance")
    for baked in (False, True, False):
        shot.focus.import_curve(CAMERA, read, baked=baked)
        spec = shot.edits.layer.GetAttributeAtPath(focus.GetPath())
        assert (spec.HasInfo("timeSamples"), spec.HasInfo("spline")) == (baked, not baked)


def test_a_tilt_is_imported_where_there_is_one(path):
    shot = Shot.open(path)
    tilted = "frame,focus_distance_m,tilt_deg,swing_deg\n1,2,0,0\n2,2,1.5,0\n3,2,3,0\n"
    shot.focus.import_curve(CAMERA, read_for_shot(shot.stage, tilted))
    camera = shot.stage.GetPrimAtPath(CAMERA)
    assert camera.GetAttribute("tiltShift:tilt").Get(2) == pytest.approx(1.5)
    straight = "frame,focus_distance_m,tilt_deg,swing_deg\n1,2,0,0\n2,2,0,0\n"
    shot.focus.import_curve(CAMERA, read_for_shot(shot.stage, straight))
    assert camera.GetAttribute("tiltShift:tilt").Get(2) == 0, "what was tilted is told to be straight"


def test_a_refused_import_changes_nothing(path):
    shot = Shot.open(path)
    before = shot.edits.export()
    with pytest.raises(InputError):
        shot.focus.import_curve(CAMERA, read_for_shot(shot.stage, "frame,focus_distance_m\n1,-2\n"))
    with pytest.raises(SettingsError, match="tilt"):
        shot.focus.import_curve(CAMERA, read_for_shot(shot.stage, "frame,focus_distance_m,tilt_deg\n1,2,89.5\n"))
    assert shot.edits.export() == before


@pytest.mark.parametrize("baked", [False, True])
def test_all_that_drives_a_camera_survives_a_layer(path, baked):
    """An exported curve, put over the shot by USD alone and solved again, is the same lens at every frame."""
    full = full_curve(24, 24.0)
    layer = curve_layer(Shot.open(path).stage, CAMERA, full, baked=baked, comment="all of it")
    pulled = path.with_name("pulled.usda")
    pulled.write_text(layer)
    root = path.with_name("root.usda")
    root.write_text(
        "#usda 1.0\n(\n    subLayers = [@./pulled.usda@, @./shot.usda@]\n    metersPerUnit = 1\n"
        '    upAxis = "Y"\n    timeCodesPerSecond = 24\n)\n'
    )
    back = Shot.open(root).focus.curve(CAMERA, full.time_codes.tolist())
    assert back.focus_distance_m == pytest.approx(np.minimum(full.focus_distance_m, 1e5), rel=1e-6)
    assert back.f_stop == pytest.approx(full.f_stop, rel=1e-6)
    assert back.focal_length_mm == pytest.approx(full.focal_length_mm, rel=1e-6)
    assert back.tilt_rad == pytest.approx(full.tilt_rad, abs=1e-9)
    assert back.swing_rad == pytest.approx(full.swing_rad, abs=1e-9)
