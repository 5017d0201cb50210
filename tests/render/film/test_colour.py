"""Ways into the working space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from render.colour import from_working, is_working_space, linearise, to_working, working_config
from render.errors import InputError, SettingsError
from tests.render.kits.colours import OWN_CONFIG


def test_srgb_texels_become_linear_and_neutral_stays_neutral() -> None:
    texel = to_working(np.full((1, 1, 3), 0.5, np.float32), "sRGB")

    np.testing.assert_allclose(texel, ((0.5 + 0.055) / 1.055) ** 2.4, rtol=5e-5)


def test_rec709_red_in_acescg() -> None:
    red = to_working(np.array([1, 0, 0], np.float32), "lin_rec709")

    # First column of the Rec. 709 to AP1 matrix with Bradford adaptation from D65 (ACES, CG configuration 2020).
    np.testing.assert_allclose(red, [0.613097, 0.070194, 0.020616], atol=1e-5)


@pytest.mark.parametrize("space", ["lin_rec709_scene", "lin_ap0_scene", "lin_p3d65_scene", "lin_rec2020_scene"])
@pytest.mark.parametrize("own", [False, True])
def test_the_way_back_from_the_working_space(space: str, own: bool, tmp_path: Path) -> None:
    """Also from a configuration without such names, which the built-in one joins."""
    (tmp_path / "own.ocio").write_text(OWN_CONFIG)
    config = working_config(tmp_path / "own.ocio") if own else None
    colours = np.random.default_rng(0).uniform(-0.5, 4, (3, 4, 4)).astype(np.float32)

    back = to_working(from_working(colours, space, config), space, config)

    np.testing.assert_allclose(back, colours, atol=5e-5)


def test_the_working_space_is_known_by_all_its_names() -> None:
    assert all(map(is_working_space, ["lin_ap1_scene", "lin_ap1", "ACEScg", "scene_linear"]))
    assert not any(map(is_working_space, ["lin_rec709_scene", "lin_ap0_scene"]))
    for space in ("srgb_rec709_scene", "raw"):
        with pytest.raises(InputError, match=f"colour space '{space}' is not linear"):
            is_working_space(space)
    with pytest.raises(InputError, match="colour space 'lin_rec90' is not known"):
        is_working_space("lin_rec90")


@pytest.mark.parametrize("source", ["raw", "data", "identity", "unknown", ""])
def test_data_is_not_converted(source: str) -> None:
    normals = np.random.default_rng(0).uniform(-1, 1, (3, 4, 3)).astype(np.float32)

    np.testing.assert_array_equal(to_working(normals, source), normals)


def test_alpha_and_the_input_are_left_alone() -> None:
    texels = np.random.default_rng(0).uniform(0, 1, (3, 4, 4)).astype(np.float32)
    before = texels.copy()

    converted = to_working(texels, "sRGB")

    np.testing.assert_array_equal(texels, before)
    np.testing.assert_array_equal(converted[..., 3], texels[..., 3])
    assert converted.shape == texels.shape


def test_every_colour_space_that_usd_names_is_known() -> None:
    names = pytest.importorskip("pxr.Gf").ColorSpaceNames
    white = np.ones(3, np.float32)

    for name in (getattr(names, attribute) for attribute in dir(names) if not attribute.startswith("_")):
        # White is white in all of them, but for XYZ, whose (1, 1, 1) is the equal-energy stimulus.
        if "ciexyz" not in name:
            np.testing.assert_allclose(to_working(white, name), white, atol=2e-4, err_msg=name)


def test_a_configuration_without_usd_names_joins_the_built_in_one(tmp_path: Path) -> None:
    (tmp_path / "own.ocio").write_text(OWN_CONFIG)
    own = working_config(tmp_path / "own.ocio")

    colour = np.array([0.2, 0.4, 0.6], np.float32)

    np.testing.assert_allclose(to_working(colour, "lin_rec709_scene", own), colour, atol=1e-5)


def test_an_unknown_colour_space_is_named() -> None:
    with pytest.raises(InputError, match="colour space 'kodachrome' is not known"):
        to_working(np.zeros(3, np.float32), "kodachrome")


def test_a_configuration_without_a_working_space_is_refused(tmp_path: Path) -> None:
    config = tmp_path / "raw.ocio"
    config.write_text(
        "ocio_profile_version: 2.0\nroles: {default: raw}\nfile_rules: [!<Rule> {name: Default, colorspace: raw}]\n"
        "displays: {Monitor: [!<View> {name: Raw, colorspace: raw}]}\ncolorspaces: [!<ColorSpace> {name: raw}]\n"
    )

    with pytest.raises(SettingsError, match="has no role scene_linear"):
        working_config(config)


def test_a_colour_space_is_found_by_name_alias_and_input_role() -> None:
    texel = np.array([[0.2, 0.5, 0.8]], np.float32)

    # The role texture_paint of OpenColorIO's default configuration is the same space as USD's sRGB.
    np.testing.assert_array_equal(to_working(texel, "texture_paint"), to_working(texel, "sRGB"))
    np.testing.assert_array_equal(to_working(texel, "lin_ap1"), texel)


def test_usd_colour_space_names_mean_the_same_in_any_configuration(tmp_path: Path) -> None:
    plain = "  - !<ColorSpace> {name: Numbers, isdata: true}\n"
    halved = "!<MatrixTransform> {matrix: [.5, 0, 0, 0, 0, .5, 0, 0, 0, 0, .5, 0, 0, 0, 0, 1]}"
    stops = f"  - !<ColorSpace> {{name: Half, to_scene_reference: {halved}}}\n"
    rival = stops.replace("Half", "sRGB")
    (tmp_path / "own.ocio").write_text(OWN_CONFIG.replace(plain, plain + stops + rival))
    own = working_config(tmp_path / "own.ocio")
    white = np.ones((1, 3), np.float32)

    np.testing.assert_allclose(to_working(white, "sRGB", own), 1, atol=5e-5)  # its matrices have about 7 digits
    np.testing.assert_allclose(to_working(white, "Half", own), 0.5, atol=5e-5)
    np.testing.assert_allclose(linearise(white, "Half", own), 0.5, atol=5e-5)


def test_a_configuration_that_was_edited_is_read_again(tmp_path: Path) -> None:
    file = tmp_path / "own.ocio"
    file.write_text(OWN_CONFIG)
    assert list(working_config(file).getDisplays()) == ["Monitor"]

    file.write_text(OWN_CONFIG.replace("Monitor", "Projector"))

    assert list(working_config(file).getDisplays()) == ["Projector"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (b"", "does not appear to have a valid version"),
        (b"not: a config\n  at all", "does not appear to have a valid version"),
        (b"ocio_profile_version: 9.9\n", "is version 9.9"),
        (b"ocio_profile_version: 2.3\nroles: {scene_linear: x}\n", "must contain either a Default file rule"),
        (b"ocio_profile_version: 2.3\ncolorspaces: [!<ColorSpace> {name: a\n", "yaml-cpp: error at line 3"),
        (b"\x00\xff\xfe\x80 no text", "it is no text"),
    ],
)
def test_a_broken_configuration_is_one_clear_sentence(tmp_path: Path, text: bytes, reason: str) -> None:
    file = tmp_path / "broken.ocio"
    file.write_bytes(text)

    with pytest.raises(SettingsError) as caught:
        working_config(file)

    message = str(caught.value)
    assert message.startswith(f"cannot read the OpenColorIO configuration {file}: ")
    assert reason in message
    assert "\n" not in message
    assert "Error:" not in message
    assert caught.value.code == "bad_colour_config"


def test_unknown_names_are_reported_with_those_they_are_near_to() -> None:
    with pytest.raises(InputError, match=r"'ACEScgg' is not known: did you mean 'ACEScg'"):
        to_working(np.zeros(3, np.float32), "ACEScgg")
    with pytest.raises(SettingsError, match=r"did you mean 'ocio://studio-config-v5.0.0_aces-v2.1_ocio-v2.6'"):
        working_config("ocio://studio-config-v5.0.0_aces-v2.1")
