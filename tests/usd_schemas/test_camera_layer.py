"""All that drives a camera in one layer, as usd-core alone reads it: no plugin, none of our Python."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom

from usd_schemas import LensCamera
from usd_schemas.curve_fit import fit_knots
from usd_schemas.curves import EXACT, author_splines, camera_layer

FRAMES = np.arange(1.0, 1001.0)
THOUSAND = np.random.default_rng(2).uniform(1, 1000, 1000)
SIX_DIGITS = 1e-6

READER = """
import json, sys
from pxr import Usd
stage = Usd.Stage.Open(sys.argv[1])
asked = json.load(sys.stdin)
prim = stage.GetPrimAtPath("/shot/cam")
known = Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("TiltShiftAPI") is not None
values = {name: [prim.GetAttribute(name).Get(t) for t in asked["times"]] for name in asked["names"]}
json.dump({"values": values, "known": known}, sys.stdout)
"""


def driven() -> dict[str, np.ndarray]:
    """A camera that follows something that moves by fits and starts, racks, zooms, and tilts through level."""
    t = FRAMES / 24
    rack = np.clip((t - 10) / 2, 0, 1)
    w = 0.4 + 0.25 * np.sin(1.7 * t) * np.sin(0.31 * t) + 0.3 * rack * rack * (3 - 2 * rack)
    return {
        "focusDistance": 100 / w,
        "fStop": np.where(t < 20, 2.8, 4.0),
        "focalLength": 35 + 15 * np.sin(0.2 * t) ** 2,
        "tiltShift:tilt": 8 * np.sin(0.9 * t),
        "tiltShift:swing": np.zeros(len(t)),
    }


@pytest.fixture
def stage(tmp_path: Path) -> Usd.Stage:
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usda"))
    stage.SetTimeCodesPerSecond(25)
    UsdGeom.Camera.Define(stage, "/shot/cam")
    stage.Save()
    return stage


def as_others_read(stage: Usd.Stage, layer: Sdf.Layer, times: np.ndarray) -> dict[str, np.ndarray]:
    """Read values in another process that has pxr alone, over the shot on disk."""
    folder = Path(stage.GetRootLayer().realPath).parent
    layer.Export(str(folder / "focus.usda"))
    top = Sdf.Layer.CreateNew(str(folder / "top.usda"))
    top.timeCodesPerSecond = stage.GetTimeCodesPerSecond()
    top.subLayerPaths[:] = ["focus.usda", "shot.usda"]
    top.Save()
    plain = {name: value for name, value in os.environ.items() if not name.startswith(("PXR_", "PYTHONPATH"))}
    done = subprocess.run(
        [sys.executable, "-I", "-c", READER, str(folder / "top.usda")],
        input=json.dumps({"times": times.tolist(), "names": list(driven())}),
        capture_output=True,
        text=True,
        check=True,
        env=plain,
        cwd=folder,
    )
    read = json.loads(done.stdout)
    assert not read["known"], "the reader must not know our schemas"
    return {name: np.array(values) for name, values in read["values"].items()}


def check_close(got: np.ndarray, wanted: np.ndarray) -> None:
    np.testing.assert_allclose(got, wanted, rtol=SIX_DIGITS, atol=SIX_DIGITS * np.abs(wanted).max())


def test_usd_alone_reads_our_values_from_splines_and_from_samples(stage: Usd.Stage) -> None:
    for form in ("spline", "samples"):
        layer = camera_layer(stage, "/shot/cam", FRAMES, driven(), form)
        read = as_others_read(stage, layer, FRAMES)
        for name, wanted in driven().items():
            np.testing.assert_allclose(read[name], wanted, rtol=SIX_DIGITS, atol=1e-12, err_msg=f"{name} as {form}")


def test_usd_alone_reads_our_curve_at_a_thousand_times_between_frames(stage: Usd.Stage) -> None:
    read = as_others_read(stage, camera_layer(stage, "/shot/cam", FRAMES, driven()), THOUSAND)
    for name, values in driven().items():
        check_close(read[name], fit_knots(FRAMES, values, EXACT * np.abs(values)).at(THOUSAND))


def test_what_is_level_or_keyed_by_few_takes_few_knots(stage: Usd.Stage) -> None:
    splines = author_splines(stage, "/shot/cam", FRAMES, driven())
    assert len(splines["tiltShift:swing"].GetKnots().keys()) == 2
    assert len(splines["fStop"].GetKnots().keys()) <= 4


def test_no_attribute_has_both_in_one_layer(stage: Usd.Stage) -> None:
    for form, has, has_not in (("spline", "spline", "timeSamples"), ("samples", "timeSamples", "spline")):
        layer = camera_layer(stage, "/shot/cam", FRAMES, driven(), form)  # type: ignore[arg-type]
        specs = layer.GetPrimAtPath("/shot/cam").attributes
        assert {spec.name for spec in specs} == set(driven())
        assert all(spec.HasInfo(has) and not spec.HasInfo(has_not) for spec in specs)


def test_the_layer_applies_the_schemas_that_it_needs(stage: Usd.Stage) -> None:
    """So that those who know the schemas take the tilt for a tilt."""
    layer = camera_layer(stage, "/shot/cam", FRAMES, driven())
    stage.GetRootLayer().subLayerPaths.append(layer.identifier)
    camera = LensCamera(stage.GetPrimAtPath("/shot/cam"))
    assert camera.tilt_shift.read(48.0).tilt_deg == pytest.approx(8 * np.sin(0.9 * 2))
    assert not camera.lens.applied


def test_a_layer_that_lists_schemas_keeps_them(stage: Usd.Stage) -> None:
    layer = Sdf.Layer.CreateAnonymous()
    listed = Sdf.TokenListOp.Create(prependedItems=["FocusAPI"])
    Sdf.CreatePrimInLayer(layer, "/shot/cam").SetInfo("apiSchemas", listed)
    for _ in range(2):
        author_splines(layer, "/shot/cam", FRAMES, {"tiltShift:tilt": driven()["tiltShift:tilt"]})
        now = layer.GetPrimAtPath("/shot/cam").GetInfo("apiSchemas")
        assert now.prependedItems == ["TiltShiftAPI", "FocusAPI"]


def test_a_stage_gets_the_schemas_too(stage: Usd.Stage) -> None:
    author_splines(stage, "/shot/cam", FRAMES, driven())
    camera = LensCamera(stage.GetPrimAtPath("/shot/cam"))
    assert camera.tilt_shift.applied
    assert camera.prim.GetAttribute("tiltShift:tilt").Get(48.0) == pytest.approx(8 * np.sin(0.9 * 2))
