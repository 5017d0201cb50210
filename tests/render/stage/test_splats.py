"""Gaussian splats of a stage: what is read of them, where they stand, and what is wrong with them."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from render.errors import StageError
from render.model.scene import Scene
from render.model.splats import MAX_SPLATS
from render.stage import StageReader, find_not_honoured
from render.stage.camera.framing import framing_camera
from render.stage.geometry import splats as splats_module
from tests.render.kits.stages import codes, instancer, new_stage, read

HARMONICS = "radiance:sphericalHarmonicsCoefficients"
KIND = "ParticleField3DGaussianSplat"


def add_splats(stage: Usd.Stage, path: str = "/cloud", count: int = 3, **values: object) -> Usd.Prim:
    """A cloud along x whose values, where not given, are in order."""
    prim = stage.DefinePrim(path, KIND)
    default: dict[str, object] = {
        "positions": Vt.Vec3fArray([Gf.Vec3f(i, 2, 3) for i in range(count)]),
        "scales": Vt.Vec3fArray([Gf.Vec3f(0.1, 0.2, 0.3)] * count),
        "orientations": Vt.QuatfArray([Gf.Quatf(1, 0, 0, 0)] * count),
        "opacities": Vt.FloatArray([0.5] * count),
        "radiance:sphericalHarmonicsDegree": 0,
        HARMONICS: Vt.Vec3fArray([Gf.Vec3f(1, 0.5, 0)] * count),
    }
    for name, value in (default | values).items():
        if value is not None:
            prim.GetAttribute(name).Set(value)
    return prim


def counts(scene: Scene) -> list[int]:
    return [len(batch.cloud.positions) for batch in scene.splats]


def test_values_are_read_in_metres() -> None:
    stage = new_stage(metres_per_unit=0.01)
    add_splats(stage)
    (batch,) = read(stage).splats
    np.testing.assert_allclose(
        batch.cloud.positions, [[0, 0.02, 0.03], [0.01, 0.02, 0.03], [0.02, 0.02, 0.03]], rtol=1e-6
    )
    np.testing.assert_allclose(batch.cloud.axes[0], np.diag([0.001, 0.002, 0.003]), rtol=1e-6)
    np.testing.assert_allclose(batch.poses, np.eye(4)[None], atol=1e-12)
    np.testing.assert_allclose(batch.cloud.harmonics, [[[1, 0.5, 0]]] * 3)
    assert batch.cloud.is_encoded


def test_orientations_turn_the_axes() -> None:
    """A quarter turn about z, of any length: x goes to y."""
    stage = new_stage()
    add_splats(stage, count=1, orientations=Vt.QuatfArray([Gf.Quatf(2, 0, 0, 2)]))
    (batch,) = read(stage).splats
    np.testing.assert_allclose(batch.cloud.axes[0], [[0, -0.2, 0], [0.1, 0, 0], [0, 0, 0.3]], atol=1e-7)


def test_half_precision_counts_where_there_is_no_other() -> None:
    stage = new_stage()
    halves = {
        "positions": None,
        "scales": None,
        "orientations": None,
        "opacities": None,
        HARMONICS: None,
        "positionsh": Vt.Vec3hArray([Gf.Vec3h(1, 2, 3)]),
        "scalesh": Vt.Vec3hArray([Gf.Vec3h(0.5, 0.25, 1)]),
        "orientationsh": Vt.QuathArray([Gf.Quath(1, 0, 0, 0)]),
        "opacitiesh": Vt.HalfArray([0.25]),
        HARMONICS + "h": Vt.Vec3hArray([Gf.Vec3h(0.5, 1, 2)]),
    }
    add_splats(stage, **halves)
    add_splats(stage, "/both", count=1, positionsh=Vt.Vec3hArray([Gf.Vec3h(7, 7, 7)]))
    half, both = (batch.cloud for batch in read(stage).splats)
    np.testing.assert_array_equal(half.positions, [[1, 2, 3]])
    np.testing.assert_array_equal(half.axes[0], np.diag([0.5, 0.25, 1]))
    np.testing.assert_array_equal(half.opacities, [0.25])
    np.testing.assert_array_equal(half.harmonics, [[[0.5, 1, 2]]])
    np.testing.assert_array_equal(both.positions, [[0, 2, 3]])


def test_lists_that_are_not_there_have_plain_values() -> None:
    stage = new_stage()
    add_splats(stage, count=2, scales=None, orientations=None, opacities=None, **{HARMONICS: None})
    (batch,) = read(stage).splats
    np.testing.assert_array_equal(batch.cloud.axes, [np.eye(3)] * 2)
    np.testing.assert_array_equal(batch.cloud.opacities, [1, 1])
    assert not batch.cloud.harmonics.any()


def test_the_attribute_says_whether_colours_are_linear() -> None:
    stage = new_stage()
    add_splats(stage).GetAttribute(HARMONICS).SetColorSpace("lin_rec709_scene")
    add_splats(stage, "/encoded").GetAttribute(HARMONICS).SetColorSpace("srgb_rec709_scene")
    add_splats(stage, "/other").GetAttribute(HARMONICS).SetColorSpace("lin_ap1_scene")
    reader = StageReader(stage)
    assert [batch.cloud.is_encoded for batch in reader.read(0).splats] == [False, True, True]
    assert [(found.code, found.path) for found in reader.findings] == [("splats_colour_space", "/other")]


def test_transforms_move_clouds_and_their_values_vary() -> None:
    stage = new_stage()
    prim = add_splats(stage)
    still = add_splats(stage, "/still")
    move = UsdGeom.Xformable(prim).AddTranslateOp()
    for time, x in ((0, 0.0), (10, 5.0)):
        move.Set(Gf.Vec3d(x, 0, 0), time)
    opacities = still.GetAttribute("opacities")
    for time, value in ((0, 0.5), (10, 0.9)):
        opacities.Set(Vt.FloatArray([value] * 3), time)
    reader = StageReader(stage)
    first, second, again = (reader.read(time).splats for time in (0.0, 10.0, 10.0))
    assert first[0].cloud is second[0].cloud
    assert second[0].poses[0, 0, 3] == pytest.approx(5)
    np.testing.assert_allclose([first[1].cloud.opacities[0], second[1].cloud.opacities[0]], [0.5, 0.9])
    assert again is second


def test_visibility_purpose_and_instances_are_those_of_prims() -> None:
    stage = new_stage()
    UsdGeom.Imageable(add_splats(stage, "/hidden")).CreateVisibilityAttr("invisible")
    UsdGeom.Imageable(add_splats(stage, "/guide")).CreatePurposeAttr("guide")
    blinks = UsdGeom.Imageable(add_splats(stage, "/blinks")).CreateVisibilityAttr()
    blinks.Set("invisible", 0)
    blinks.Set("inherited", 5)
    add_splats(stage, "/many/proto/cloud")
    instancer(stage, "/many", ["/many/proto"], [0, 0])
    reader = StageReader(stage)
    (many,) = reader.read(0).splats
    np.testing.assert_allclose(many.poses[:, 0, 3], [0, 10])
    assert reader.read(0).prim_paths[many.prim_id] == "/many"
    assert len(reader.read(5).splats) == 2


BAD = float("nan")


def test_bad_splats_are_left_out_with_one_finding() -> None:
    stage = new_stage()
    positions = Vt.Vec3fArray(
        [Gf.Vec3f(0), Gf.Vec3f(BAD, 0, 0), Gf.Vec3f(1e30, 0, 0), Gf.Vec3f(1), Gf.Vec3f(2), Gf.Vec3f(3)]
    )
    turns = Vt.QuatfArray([Gf.Quatf(1, 0, 0, 0)] * 5 + [Gf.Quatf(0, 0, 0, 0)])
    opacities = Vt.FloatArray([0.5, 0.5, 0.5, float("inf"), 0.0, 0.5])
    add_splats(stage, count=6, positions=positions, orientations=turns, opacities=opacities)
    add_splats(stage, "/good")
    reader = StageReader(stage)
    assert counts(reader.read(0)) == [1, 3]
    (finding,) = reader.findings
    assert (finding.code, finding.path) == ("bad_splats", "/cloud")
    assert "4 of 6 splats" in finding.message


@pytest.mark.parametrize(
    ("values", "drawn", "code"),
    [
        ({"scales": Vt.Vec3fArray(2)}, 2, "bad_splats_count"),
        ({"opacities": Vt.FloatArray([0.5] * 9)}, 3, "bad_splats_count"),
        ({"radiance:sphericalHarmonicsDegree": 1}, None, "bad_geometry"),
        ({"radiance:sphericalHarmonicsDegree": -1}, None, "bad_geometry"),
        ({"radiance:sphericalHarmonicsDegree": 2147483647}, None, "bad_geometry"),
        ({"positions": None}, None, "bad_geometry"),
        ({"positions": Vt.Vec3fArray([Gf.Vec3f(BAD)] * 3)}, None, "bad_geometry"),
        ({HARMONICS: Vt.Vec3fArray([Gf.Vec3f(1e30)] * 3)}, None, "bad_geometry"),
        (
            {"radiance:sphericalHarmonicsDegree": 4, HARMONICS: Vt.Vec3fArray([Gf.Vec3f(0.5)] * 75)},
            3,
            "splats_degree",
        ),
    ],
)
def test_impossible_values_are_findings(values: dict[str, object], drawn: int | None, code: str) -> None:
    stage = new_stage()
    add_splats(stage, **values)
    add_splats(stage, "/good", count=4)
    reader = StageReader(stage)
    assert counts(reader.read(0)) == [*([] if drawn is None else [drawn]), 4]
    assert [(finding.code, finding.path) for finding in reader.findings] == [(code, "/cloud")]


def test_values_of_other_types_are_findings() -> None:
    stage = new_stage()
    add_splats(stage, "/good")
    root = stage.GetRootLayer()
    for number, (name, kind) in enumerate(
        [
            ("positions", "string[]"),
            ("scales", "float[]"),
            ("opacities", "token"),
            ("orientations", "int[]"),
            (HARMONICS, "double"),
        ]
    ):
        path = f"/bad{number}"
        add_splats(stage, path, **{name: None})
        spec = Sdf.AttributeSpec(root.GetPrimAtPath(path), name, Sdf.ValueTypeNames.Find(kind))
        spec.default = {"string[]": ["x"] * 3, "float[]": [1.0] * 3, "token": "x", "int[]": [1] * 3, "double": 1.0}[
            kind
        ]
    reader = StageReader(stage)
    assert counts(reader.read(0)) == [3]
    assert {finding.path for finding in reader.findings} == {f"/bad{number}" for number in range(5)}
    assert codes(reader) == {"bad_geometry"}


def test_splats_beyond_the_limit_are_findings(monkeypatch: pytest.MonkeyPatch) -> None:
    assert MAX_SPLATS >= 1_000_000
    monkeypatch.setattr(splats_module, "MAX_SPLATS", 5)
    monkeypatch.setattr("render.stage.assembly.splats.MAX_SPLATS", 5)
    stage = new_stage()
    add_splats(stage, "/a", count=4)
    add_splats(stage, "/b", count=2)
    add_splats(stage, "/c", count=6)
    reader = StageReader(stage)
    assert counts(reader.read(0)) == [4]
    assert {finding.path: finding.code for finding in reader.findings} == {
        "/b": "too_many_splats",
        "/c": "bad_geometry",
    }


def test_hints_that_are_not_followed_are_named() -> None:
    stage = new_stage()
    prim = add_splats(stage)
    assert not find_not_honoured(stage)
    prim.GetAttribute("sortingModeHint").Set("rayHitDistance")
    assert [finding.path for finding in find_not_honoured(stage)] == ["/cloud.sortingModeHint"]


def test_other_particle_fields_are_not_drawn() -> None:
    stage = new_stage()
    stage.DefinePrim("/field", "ParticleField")
    reader = StageReader(stage)
    assert not reader.read(0).splats
    assert codes(reader) == {"unsupported_geometry"}


def test_a_shot_without_splats_loads_no_code_for_them(tmp_path: Path) -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/ball")
    stage.Export(str(tmp_path / "shot.usda"))
    code = (
        "import sys\n"
        "from pxr import Usd\n"
        "from render.stage import StageReader\n"
        f"StageReader(Usd.Stage.Open({str(tmp_path / 'shot.usda')!r})).read(0)\n"
        "print(*(name for name in sys.modules if name.endswith('.splats') and name != 'render.model.splats'))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, []), done.stderr


def test_a_stage_of_splats_alone_can_be_framed() -> None:
    stage = new_stage()
    assert add_splats(stage)
    box = framing_camera(stage, 0.0).world_from_camera[:3, 3]
    np.testing.assert_allclose(box[:2], [1.0, 2.0])
    assert box[2] > 3
    stage.GetPrimAtPath("/cloud").GetAttribute("positions").Set(Vt.Vec3fArray([Gf.Vec3f(BAD)]))
    with pytest.raises(StageError, match="nothing that a camera could frame"):
        framing_camera(stage, 0.0)
