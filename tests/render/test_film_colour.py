"""Ways into the working space."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from render.colour import to_working, working_config
from render.errors import InputError, SettingsError

# A studio's own configuration: it works in linear Rec. 709 and has no names in common with USD's.
OWN_CONFIG = """
ocio_profile_version: 2.3
roles: {default: Studio Linear, scene_linear: Studio Linear, aces_interchange: AP0, data: Numbers}
file_rules: [!<Rule> {name: Default, colorspace: Studio Linear}]
displays: {Monitor: [!<View> {name: Plain, colorspace: Studio Linear}]}
colorspaces:
  - !<ColorSpace> {name: AP0}
  - !<ColorSpace> {name: Numbers, isdata: true}
  - !<ColorSpace>
    name: Studio Linear
    to_scene_reference: !<MatrixTransform>
      matrix: [0.439632982, 0.382988698, 0.17737832, 0, 0.0897764431, 0.813439429, 0.0967841284, 0,
               0.0175411704, 0.111546553, 0.870912277, 0, 0, 0, 0, 1]
"""


def test_srgb_texels_become_linear_and_neutral_stays_neutral() -> None:
    texel = to_working(np.full((1, 1, 3), 0.5, np.float32), "sRGB")

    np.testing.assert_allclose(texel, ((0.5 + 0.055) / 1.055) ** 2.4, rtol=5e-5)


def test_rec709_red_in_acescg() -> None:
    red = to_working(np.array([1, 0, 0], np.float32), "lin_rec709")

    # First column of the Rec. 709 to AP1 matrix with Bradford adaptation from D65 (ACES, CG configuration 2020).
    np.testing.assert_allclose(red, [0.613097, 0.070194, 0.020616], atol=1e-5)


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


def test_a_configuration_without_usds_names_is_joined_to_the_built_in_one(tmp_path: Path) -> None:
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
