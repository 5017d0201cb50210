"""Sheen and thin films of MaterialX's surfaces under an even sky, against integrals of their models."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import UsdLux

from render.frame import FrameRenderer
from render.model.arrays import DoubleArray, FloatArray
from tests.render.kits.materialx_walls import document, picture, wall

pytestmark = pytest.mark.gl

BLACK = {"base": "0", "specular": "0", "specular_roughness": "1"}
MIRROR = {"base": "0", "specular_roughness": "0.03"}
WAVES_NM = np.arange(380.0, 781.0)
REC709 = np.array(
    [[3.2404542, -1.5371385, -0.4985314], [-0.969266, 1.8760108, 0.041556], [0.0556434, -0.2040259, 1.0572252]]
)


def _seen(renderer: FrameRenderer, folder: Path, category: str = "standard_surface", **values: str) -> FloatArray:
    """Light of a wall, 4 m wide and as far away, under a sky of radiance 1."""
    inputs = "".join(
        f'<input name="{name}" type="{"color3" if "," in value else "float"}" value="{value}"/>'
        for name, value in values.items()
    )
    stage = wall(folder, document(f'<{category} name="S" type="surfaceshader">{inputs}</{category}>'))
    UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(1.0)
    return picture(renderer, stage, 5)[..., :3]


def _sheen(nv: float, roughness: float, n: int = 200) -> float:
    """Share that Estevez & Kulla's sheen reflects, without masking as in MaterialX."""
    steps = (np.arange(n) + 0.5) / n
    theta, phi = np.meshgrid(steps * np.pi / 2, steps * 2 * np.pi)
    light = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], -1)
    half = light + np.array([np.sqrt(1 - nv * nv), 0, nv])
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    nl, sine2 = light[..., 2], 1 - np.minimum(half[..., 2], 1) ** 2
    normals = (2 + 1 / roughness) * sine2 ** (0.5 / roughness) / (2 * np.pi)
    shares = normals / (4 * (nl + nv - nl * nv)) * nl * np.sin(theta)
    return float(shares.sum() * (np.pi / 2 / n) * (2 * np.pi / n))


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.8])
def test_a_sheen_reflects_what_its_model_does(renderer: FrameRenderer, tmp_path: Path, roughness: float) -> None:
    """As near as MaterialX's fit is to the integral."""
    got = _seen(renderer, tmp_path, **BLACK, sheen="1", sheen_color="1,0.5,0", sheen_roughness=str(roughness))
    corner = 4 / np.sqrt(16 + 2 * 1.6**2)
    np.testing.assert_allclose(got[2, 2], np.array([1, 0.5, 0]) * _sheen(1.0, roughness), atol=0.013)
    np.testing.assert_allclose(got[0, 0], np.array([1, 0.5, 0]) * _sheen(corner, roughness), atol=0.013)


@pytest.mark.parametrize(
    ("category", "values"),
    [
        (
            "standard_surface",
            {"base": "1", "base_color": "1,1,1", "specular": "0", "specular_roughness": "1", "sheen": "1"},
        ),
        (
            "open_pbr_surface",
            {"base_color": "1,1,1", "specular_weight": "0", "specular_roughness": "1", "fuzz_weight": "1"},
        ),
        ("disney_principled", {"baseColor": "1,1,1", "specular": "0", "roughness": "1", "sheen": "1"}),
        ("gltf_pbr", {"metallic": "0", "specular": "0", "sheen_color": "1,1,1", "sheen_roughness": "0.6"}),
    ],
)
def test_a_white_sheen_on_white_neither_adds_nor_takes(
    renderer: FrameRenderer, tmp_path: Path, category: str, values: dict[str, str]
) -> None:
    np.testing.assert_allclose(_seen(renderer, tmp_path, category, **values), 1, atol=0.005)


def test_a_sheen_tints_the_colour_of_a_metal(renderer: FrameRenderer, tmp_path: Path) -> None:
    """As pictures without light show it."""
    inputs = (
        '<input name="base_color" type="color3" value="1,0,0"/><input name="base_metalness" type="float" value="1"/>'
        '<input name="fuzz_weight" type="float" value="1"/><input name="fuzz_color" type="color3" value="0,0,1"/>'
        '<input name="fuzz_roughness" type="float" value="1"/>'
    )
    stage = wall(tmp_path, document(f'<open_pbr_surface name="S" type="surfaceshader">{inputs}</open_pbr_surface>'))
    red, green, blue = picture(renderer, stage, 5, shading="unlit")[2, 2, :3].tolist()
    assert 0.05 < blue < 0.5
    assert red == pytest.approx(1 - blue, abs=0.002)
    assert green == pytest.approx(0, abs=0.002)


def _bell(middle: float, below: float, above: float) -> DoubleArray:
    return np.exp(-0.5 * ((WAVES_NM - middle) * np.where(middle > WAVES_NM, below, above)) ** 2)


def _film(film: float, base: float, thickness_nm: float) -> DoubleArray:
    """Reflectance head-on by Airy's sum, in Rec. 709 by Wyman, Sloan & Shirley's fit of the CIE's observer; white is even."""
    first, second = (1 - film) / (1 + film), (film - base) / (film + base)
    wave = 2 * first * second * np.cos(4 * np.pi * film * thickness_nm / WAVES_NM)
    share = (first**2 + second**2 + wave) / (1 + (first * second) ** 2 + wave)
    observer = np.stack(
        [
            0.362 * _bell(442, 0.0624, 0.0374)
            + 1.056 * _bell(599.8, 0.0264, 0.0323)
            - 0.065 * _bell(501.1, 0.049, 0.0382),
            0.821 * _bell(568.8, 0.0213, 0.0247) + 0.286 * _bell(530.9, 0.0613, 0.0322),
            1.217 * _bell(437, 0.0845, 0.0278) + 0.681 * _bell(459, 0.0385, 0.0725),
        ]
    )
    rgb: DoubleArray = REC709 @ (observer @ (share - share.mean())) / observer[1].sum() + share.mean()
    return np.maximum(rgb, 0)


@pytest.mark.parametrize(("film", "base", "nm"), [(1.33, 1.5, 300), (2.0, 1.5, 400), (1.5, 2.5, 300), (1.4, 1.5, 550)])
def test_a_thin_film_colours_what_is_reflected(
    renderer: FrameRenderer, tmp_path: Path, film: float, base: float, nm: float
) -> None:
    values = {"specular_IOR": str(base), "thin_film_thickness": str(nm), "thin_film_IOR": str(film)}
    got = _seen(renderer, tmp_path, **MIRROR, **values)[2, 2]
    # the sky's reflectance is that of a roughness of 0.03, and the film that of two orders of reflection
    np.testing.assert_allclose(got, _film(film, base, nm), atol=0.012)


def test_a_film_of_lobes_equals_a_standard_surface(renderer: FrameRenderer, tmp_path: Path) -> None:
    nodes = (
        '<roughness_anisotropy name="r" type="vector2"><input name="roughness" type="float" value="0.03"/></roughness_anisotropy>'
        '<dielectric_bsdf name="d" type="BSDF"><input name="thinfilm_thickness" type="float" value="400"/>'
        '<input name="thinfilm_ior" type="float" value="2"/><input name="roughness" type="vector2" nodename="r"/>'
        "</dielectric_bsdf>"
        '<sheen_bsdf name="s" type="BSDF"><input name="weight" type="float" value="0.5"/></sheen_bsdf>'
        '<layer name="b" type="BSDF"><input name="top" type="BSDF" nodename="s"/>'
        '<input name="base" type="BSDF" nodename="d"/></layer>'
    )
    surface = '<surface name="S" type="surfaceshader"><input name="bsdf" type="BSDF" nodename="b"/></surface>'
    lobes, plain = tmp_path / "lobes", tmp_path / "plain"
    lobes.mkdir()
    plain.mkdir()
    stage = wall(lobes, document(surface, nodes))
    UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(1.0)
    want = _seen(renderer, plain, **MIRROR, sheen="0.5", thin_film_thickness="400", thin_film_IOR="2")
    assert want[2, 2, 0] > 0.15
    np.testing.assert_allclose(picture(renderer, stage, 5)[..., :3], want, atol=1e-3)
