"""Surfaces that are built of MaterialX's lobes, against a standard_surface of the same numbers."""

from __future__ import annotations

import re
from pathlib import Path

import MaterialX as mx
import numpy as np
import pytest

from render.frame import FrameRenderer
from tests.render.kits.materialx_walls import add_lamp, add_light, document, picture, wall

pytestmark = pytest.mark.gl


def _value(name: str, value: str) -> str:
    kind = {0: "float", 1: "vector2", 2: "color3"}[value.count(",")]
    return f'<input name="{name}" type="{kind}" value="{value}"/>'


def _node(category: str, name: str, kind: str, *inputs: str) -> str:
    return f'<{category} name="{name}" type="{kind}">{"".join(inputs)}</{category}>'


def _link(name: str, kind: str, node: str) -> str:
    return f'<input name="{name}" type="{kind}" nodename="{node}"/>'


def _lobe(category: str, name: str, *inputs: str) -> str:
    return _node(category, name, "BSDF", *inputs)


def _layer(name: str, top: str, base: str) -> str:
    return _lobe("layer", name, _link("top", "BSDF", top), _link("base", "BSDF", base))


def _rough(name: str, roughness: str) -> str:
    return _node("roughness_anisotropy", name, "vector2", _value("roughness", roughness))


COLOR = "0.6,0.3,0.1"
PAINT = (
    _rough("ra", "0.35")
    + _lobe("oren_nayar_diffuse_bsdf", "d", _value("color", COLOR))
    + _lobe("dielectric_bsdf", "s", _value("ior", "1.6"), _link("roughness", "vector2", "ra"))
)
METAL = (
    PAINT
    + _layer("l", "s", "d")
    + _lobe("generalized_schlick_bsdf", "m", _value("color0", COLOR), _link("roughness", "vector2", "ra"))
)
SIDES = _link("fg", "BSDF", "m") + _link("bg", "BSDF", "l")
SHARE = _node("constant", "c", "float", _value("value", "0.3"))
COAT = (
    PAINT
    + _layer("l", "s", "d")
    + _rough("rc", "0.2")
    + _lobe("multiply", "p", _link("in1", "BSDF", "l"), _value("in2", "1,1,1"))
    + _lobe("dielectric_bsdf", "k", _value("weight", "0.8"), _link("roughness", "vector2", "rc"))
    + _layer("b", "k", "p")
)
ALPHAS = PAINT.replace(_link("roughness", "vector2", "ra"), _value("roughness", "0.1225,0.1225"))
MODE = '<input name="scatter_mode" type="string" value="T"/>'
GLASS = _lobe("dielectric_bsdf", "b", _value("tint", "1,0.5,0.75"), MODE)
GLOW = (
    _node("uniform_edf", "u", "EDF", _value("color", "0.2,0.4,0.6"))
    + _node("multiply", "e", "EDF", _link("in1", "EDF", "u"), _value("in2", "2"))
    + _lobe("oren_nayar_diffuse_bsdf", "b", _value("weight", "0"))
)
STANDARD = {"base": "1", "base_color": COLOR, "specular_roughness": "0.35", "specular_IOR": "1.6"}
HALF_METAL = STANDARD | {"metalness": "0.3"}
NOTHING = {"base": "0", "specular": "0", "specular_roughness": "1"}
CASES = {
    "a mix by a constant": (METAL + _lobe("mix", "b", SIDES, _value("mix", "0.3")), HALF_METAL),
    "a mix by a node": (METAL + SHARE + _lobe("mix", "b", SIDES, _link("mix", "float", "c")), HALF_METAL),
    "a roughness by its alphas": (ALPHAS + _layer("b", "s", "d"), STANDARD),
    "a coat": (COAT, STANDARD | {"coat": "0.8", "coat_roughness": "0.2"}),
    "light of its own": (GLOW, NOTHING | {"emission": "2", "emission_color": "0.2,0.4,0.6"}),
    "glass": (GLASS, NOTHING | {"transmission": "1", "transmission_color": "1,0.5,0.75"}),
}


@pytest.mark.parametrize("case", list(CASES))
def test_lobes_equal_a_standard_surface(renderer: FrameRenderer, tmp_path: Path, case: str) -> None:
    nodes, standard = CASES[case]
    lobes = _node("surface", "S", "surfaceshader", _link("bsdf", "BSDF", "b"), _link("edf", "EDF", "e"))
    plain = _node("standard_surface", "S", "surfaceshader", *(_value(*each) for each in standard.items()))
    pictures = []
    for number, text in enumerate((document(lobes, nodes), document(plain))):
        folder = tmp_path / str(number)
        folder.mkdir()
        stage = wall(folder, text)
        add_light(stage)
        add_lamp(stage)
        pictures.append(picture(renderer, stage))
    assert pictures[1][..., :3].max() > 0.2
    np.testing.assert_allclose(pictures[0], pictures[1], atol=0.004)


def _studio_surface() -> str:
    """MaterialX's own definition of standard_surface by lobes, under another name."""
    text = (Path(mx.__file__).parent / "libraries/bxdf/standard_surface.mtlx").read_text()
    text = re.sub(r'<nodedef name="ND_standard_surface_surfaceshader" .*?</nodedef>', "", text, flags=re.DOTALL)
    inside = re.sub(r".*?<materialx[^>]*>(.*)</materialx>.*", r"\1", text, flags=re.DOTALL)
    return inside.replace("standard_surface", "studio_surface")


@pytest.mark.parametrize(
    "values",
    [
        {"base_color": COLOR, "metalness": "0.4", "specular_roughness": "0.4", "coat": "0.7", "sheen": "0.5"},
        {"transmission": "0.8", "specular_roughness": "0.1", "thin_film_thickness": "400"},
        {"base_color": COLOR, "subsurface": "0.5", "subsurface_color": "0.9,0.2,0.1", "opacity": "0.5,0.5,0.5"},
        {"emission": "1", "emission_color": "0.2,0.3,0.4", "base": "0.3", "specular_color": "0.3,0.5,0.7"},
    ],
)
def test_materialxs_own_standard_surface_is_reduced(
    renderer: FrameRenderer, tmp_path: Path, values: dict[str, str]
) -> None:
    pictures = []
    for category, nodes in (("studio_surface", _studio_surface()), ("standard_surface", "")):
        folder = tmp_path / category
        folder.mkdir()
        given = {"base": "0.8", "base_color": "1,1,1"} | values
        stage = wall(
            folder, document(_node(category, "S", "surfaceshader", *(_value(*each) for each in given.items())), nodes)
        )
        add_light(stage)
        add_lamp(stage)
        pictures.append(picture(renderer, stage, 8))
    assert pictures[1][..., :3].max() > 0.2
    np.testing.assert_allclose(pictures[0], pictures[1], atol=0.004)
