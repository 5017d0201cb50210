"""IES files: how bright a light is in each direction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, UsdLux

from render.model.scene import PROFILE_SHAPE
from render.stage import StageReader, find_not_honoured
from render.stage.photometry import ProfileError, bake, parse
from tests.render.kits.stages import codes, new_stage

EVEN = "0 90 180\n0\n50 50 50\n"


def photometric_file(
    angles: str = EVEN, *, counts: str = "3 1", tilt: str = "TILT=NONE", factors: str = "2 1 1", kind: int = 1
) -> str:
    """A file with a multiplier, a ballast factor and a ballast-lamp factor."""
    multiplier, ballast, lamp = factors.split()
    return (
        f"IESNA:LM-63-2002\n[TEST] none\n{tilt}\n1 1000 {multiplier} {counts} {kind} 2 0 0 0\n"
        f"{ballast} {lamp} 60\n{angles}"
    )


def test_candela_are_scaled_by_the_factors_of_the_file() -> None:
    found = parse(photometric_file(factors="2 0.5 0.8"))
    np.testing.assert_allclose(found.intensity, [[40, 40, 40]])
    np.testing.assert_allclose(bake(found, 0.0, normalize=False), np.full(PROFILE_SHAPE, 40))
    np.testing.assert_allclose(bake(found, 0.0, normalize=True), np.ones(PROFILE_SHAPE), rtol=1e-6)


def test_tilt_is_passed_over() -> None:
    included = "TILT=INCLUDE\n1\n3\n0 90 180\n1 0.9\n0.8"
    np.testing.assert_array_equal(parse(photometric_file(tilt=included)).intensity, parse(photometric_file()).intensity)


def test_a_downlight_is_normalised_over_its_hemisphere() -> None:
    """A cosine: its mean over a hemisphere is a half."""
    vertical = np.linspace(0, 90, 91)
    rows = " ".join(map(str, vertical)) + "\n0\n" + " ".join(str(np.cos(np.radians(v))) for v in vertical) + "\n"
    found = parse(photometric_file(rows, counts="91 1"))
    assert found.mean() == pytest.approx(2 * 0.5, rel=1e-3)
    table = bake(found, 0.0, normalize=True)
    np.testing.assert_allclose(table[0, :128], 2 * np.cos(np.linspace(0, np.pi, 256)[:128]), atol=2e-3)
    assert (table[:, 129:] == 0).all()


@pytest.mark.parametrize(
    ("horizontal", "at", "expected"),
    [
        ("0 90", [0, 90, 180, 270, 45, 135, 315], [1, 3, 1, 3, 2, 2, 2]),
        ("0 180", [0, 90, 180, 270, 315], [1, 2, 3, 2, 1.5]),
        ("90 270", [90, 180, 270, 0, 45, 315], [1, 2, 3, 2, 1.5, 2.5]),
        ("0 360", [0, 90, 270], [1, 1.5, 2.5]),
    ],
)
def test_symmetric_files_go_all_around(horizontal: str, at: list[float], expected: list[float]) -> None:
    found = parse(photometric_file(f"0 180\n{horizontal}\n1 1\n3 3\n", counts="2 2", factors="1 1 1"))
    np.testing.assert_allclose(found.at(np.array([1.0]), np.radians(at))[:, 0], expected)


def test_the_angle_scale_stretches_the_profile() -> None:
    found = parse(photometric_file("0 45 90\n0\n4 2 0\n", factors="1 1 1"))
    polar = np.linspace(0, np.pi, PROFILE_SHAPE[1])
    for scale, expected in ((0.0, polar), (2.0, polar / 2), (0.5, polar * 2)):
        shown = bake(found, scale, normalize=False)[0]
        np.testing.assert_allclose(shown, np.interp(np.degrees(expected), [0, 45, 90], [4, 2, 0]), atol=1e-5)
    upwards = parse(photometric_file("90 135 180\n0\n0 2 4\n", factors="1 1 1"))
    np.testing.assert_allclose(
        bake(upwards, -2.0, normalize=False)[0], bake(found, 2.0, normalize=False)[0, ::-1], atol=1e-5
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is no photometric file"),
        ("PK\x03\x04 TILT=NONE", "is no photometric file"),
        ("IESNA TILT=NONE\n1 2", "ends too early"),
        (photometric_file("0 90 180\n0\n1 1\n"), "ends too early"),
        (photometric_file("0 90 180\n0\n1 one 1\n"), "words among its numbers"),
        (photometric_file("0 90 180\n0\n1 nan 1\n"), "out of range"),
        (photometric_file("0 90 180\n0\n1 1e300 1\n"), "out of range"),
        (photometric_file("0 90 180\n0\n1 9e8 1\n"), "too bright"),
        (photometric_file("0 180 90\n0\n1 1 1\n"), "do not ascend"),
        (photometric_file("0 90\n0 70\n1 1\n1 1\n", counts="2 2"), "do not close"),
        (photometric_file(kind=3), "photometric type 3"),
        (photometric_file(counts="99999 99999"), "too many"),
        (photometric_file(counts="1e8 1"), "vertical angles"),
        (photometric_file(counts="-3 1"), "-3 vertical angles"),
        (photometric_file(tilt="TILT=INCLUDE\n1\n1e9"), "angles of its tilt"),
    ],
)
def test_a_file_that_is_none_has_a_reason(text: str, message: str) -> None:
    with pytest.raises(ProfileError, match=message):
        parse(text)


def test_a_dark_profile_cannot_be_normalised() -> None:
    dark = parse(photometric_file("0 90 180\n0\n0 0 0\n"))
    assert (bake(dark, 0.0, normalize=False) == 0).all()
    with pytest.raises(ProfileError, match="is dark"):
        bake(dark, 0.0, normalize=True)


def test_a_light_has_its_profile_or_a_finding(tmp_path: Path) -> None:
    (tmp_path / "even.ies").write_text(photometric_file())
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    shaping = UsdLux.ShapingAPI.Apply(light.GetPrim())
    shaping.CreateShapingIesFileAttr(Sdf.AssetPath(str(tmp_path / "even.ies")))
    shaping.CreateShapingIesNormalizeAttr(True)
    reader = StageReader(stage)
    profile = reader.read(0).lights[0].profile
    assert profile is not None
    np.testing.assert_allclose(profile, 1, rtol=1e-6)
    assert reader.read(1).lights[0].profile is profile
    assert reader.findings == find_not_honoured(stage) == []
    shaping.GetShapingIesFileAttr().Set(Sdf.AssetPath(str(tmp_path / "gone.ies")))
    lost = StageReader(stage)
    assert lost.read(0).lights[0].profile is None
    assert codes(lost) == {"bad_profile"}


def test_a_profile_outside_of_its_shot_is_not_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inside, outside = tmp_path / "shot", tmp_path / "secret.ies"
    inside.mkdir()
    outside.write_text(photometric_file())
    stage = new_stage()
    light = UsdLux.SphereLight.Define(stage, "/l")
    UsdLux.ShapingAPI.Apply(light.GetPrim()).CreateShapingIesFileAttr(Sdf.AssetPath(str(outside)))
    monkeypatch.setattr("render.stage.lights.confinement", lambda _: inside)
    reader = StageReader(stage)
    assert reader.read(0).lights[0].profile is None
    assert [finding.message for finding in reader.findings] == [
        f"IES file {outside} lies outside what was given; light /l shines as without it"
    ]


def test_a_profile_too_bright_for_its_mean_is_refused() -> None:
    text = photometric_file("0 0.1 180\n0\n1e9 1e-300 1e-300")
    with pytest.raises(ProfileError, match="too bright"):
        bake(parse(text), 0.0, normalize=True)
