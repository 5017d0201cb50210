"""Each kind of material, on a ball."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdShade, Vt

from tests.render.kits.kinds.parts import Author, T, ball
from tests.render.kits.stages import add_material, add_texture, bind, write_picture


def _preview(**inputs: object) -> Author:
    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        add_material(stage, f"{path}_look", **inputs)
        bind(ball(stage, path), f"{path}_look")

    return author


def _textured(file: str, pixels: np.ndarray, **inputs: object) -> Author:
    """Ball whose diffuse colour, or opacity where the pixels have an alpha, is a texture; UDIM sets are two tiles wide."""

    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        for number, part in enumerate(np.split(pixels, 2, axis=1) if "<UDIM>" in file else [pixels]):
            write_picture(folder / file.replace("<UDIM>", str(1001 + number)), np.ascontiguousarray(part))
        prim = ball(stage, path)
        if "<UDIM>" in file:
            primvar = UsdGeom.PrimvarsAPI(prim).GetPrimvar("st")
            primvar.Set(Vt.Vec2fArray.FromNumpy((np.array(primvar.Get()) * (2, 1)).clip(0, 1.999).astype(np.float32)))
        shader = add_material(stage, f"{path}_look", **inputs)
        texture = add_texture(stage, f"{path}_look/texture", f"./{file}")
        shader.CreateInput("diffuseColor", T.Color3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
        if pixels.shape[2] == 4:
            shader.CreateInput("opacity", T.Float).ConnectToSource(texture.CreateOutput("a", T.Float))
        bind(prim, f"{path}_look")

    return author


def _bumped(stage: Usd.Stage, path: str, folder: Path) -> None:
    x = np.arange(256) / 256 * 2 * np.pi
    slopes = 0.5 * np.stack(np.meshgrid(np.cos(16 * x), np.cos(8 * x)), axis=2)
    normals = np.concatenate([slopes, np.ones((256, 256, 1))], axis=2)
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    write_picture(folder / "normals.png", np.round(127.5 + 127.5 * normals).astype(np.uint8))
    shader = add_material(stage, f"{path}_look", diffuseColor=Gf.Vec3f(0.15, 0.3, 0.5), roughness=0.35)
    texture = add_texture(stage, f"{path}_look/normals", "./normals.png")
    texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
    texture.CreateInput("scale", T.Float4).Set((2, 2, 2, 1))
    texture.CreateInput("bias", T.Float4).Set((-1, -1, -1, 0))
    shader.CreateInput("normal", T.Normal3f).ConnectToSource(texture.CreateOutput("rgb", T.Float3))
    bind(ball(stage, path), f"{path}_look")


def _by_materialx(name: str) -> Author:
    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        (folder / "kinds.mtlx").write_text(DOCUMENT)
        if not stage.GetPrimAtPath("/MaterialX"):
            stage.DefinePrim("/MaterialX", "Scope").GetReferences().AddReference("./kinds.mtlx", "/MaterialX")
        binding = UsdShade.MaterialBindingAPI.Apply(ball(stage, path))
        binding.GetPrim().CreateRelationship("material:binding").SetTargets([f"/MaterialX/Materials/{name}"])

    return author


def _checks(size: int = 256, squares: int = 8, alpha: bool = False) -> np.ndarray:
    places = np.arange(2 * size) * squares // size
    is_dark = (places[None] + places[:size, None]) % 2
    pixels = np.where(is_dark[..., None], (40, 60, 160), (230, 190, 60)).astype(np.uint8)
    return np.concatenate([pixels, (255 * is_dark[..., None]).astype(np.uint8)], axis=2) if alpha else pixels


DOCUMENT = """<?xml version="1.0"?>
<materialx version="1.39" colorspace="lin_rec709">
  <nodegraph name="NG_marble">
    <position name="place" type="vector3"/>
    <fractal3d name="veins" type="float"><input name="position" type="vector3" nodename="stretched"/></fractal3d>
    <multiply name="stretched" type="vector3"><input name="in1" type="vector3" nodename="place"/>
      <input name="in2" type="float" value="2.5"/></multiply>
    <absval name="crests" type="float"><input name="in" type="float" nodename="veins"/></absval>
    <smoothstep name="share" type="float"><input name="in" type="float" nodename="crests"/>
      <input name="low" type="float" value="0"/><input name="high" type="float" value="0.15"/></smoothstep>
    <mix name="colour" type="color3"><input name="fg" type="color3" value="0.75, 0.72, 0.68"/>
      <input name="bg" type="color3" value="0.08, 0.10, 0.14"/><input name="mix" type="float" nodename="share"/></mix>
    <output name="out" type="color3" nodename="colour"/>
  </nodegraph>
  <standard_surface name="S_marble" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="NG_marble" output="out"/>
    <input name="specular_roughness" type="float" value="0.15"/>
  </standard_surface>
  <surfacematerial name="marble" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S_marble"/></surfacematerial>

  <checkerboard name="board" type="color3"><input name="uvtiling" type="vector2" value="12, 6"/>
    <input name="color1" type="color3" value="0.6, 0.02, 0.02"/>
    <input name="color2" type="color3" value="0.7, 0.6, 0.4"/></checkerboard>
  <open_pbr_surface name="S_lacquer" type="surfaceshader">
    <input name="base_color" type="color3" nodename="board"/><input name="specular_roughness" type="float" value="0.6"/>
    <input name="coat_weight" type="float" value="1"/><input name="coat_roughness" type="float" value="0.05"/>
  </open_pbr_surface>
  <surfacematerial name="lacquer" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S_lacquer"/></surfacematerial>

  <worleynoise2d name="cells" type="float"><input name="texcoord" type="vector2" nodename="tiled"/></worleynoise2d>
  <texcoord name="st" type="vector2"/>
  <multiply name="tiled" type="vector2"><input name="in1" type="vector2" nodename="st"/>
    <input name="in2" type="vector2" value="24, 12"/></multiply>
  <gltf_pbr name="S_hammered" type="surfaceshader">
    <input name="base_color" type="color3" value="0.9, 0.6, 0.25"/><input name="metallic" type="float" value="1"/>
    <input name="roughness" type="float" nodename="cells"/>
  </gltf_pbr>
  <surfacematerial name="hammered" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S_hammered"/></surfacematerial>

  <standard_surface name="S_glass" type="surfaceshader">
    <input name="transmission" type="float" value="1"/><input name="specular_roughness" type="float" value="0.05"/>
    <input name="transmission_color" type="color3" value="0.6, 0.9, 0.7"/>
  </standard_surface>
  <surfacematerial name="glass" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="S_glass"/></surfacematerial>
</materialx>
"""

MATERIALS: dict[str, Author] = {
    "plastic": _preview(diffuseColor=Gf.Vec3f(0.6, 0.08, 0.05), roughness=0.3),
    "metal": _preview(diffuseColor=Gf.Vec3f(0.9, 0.75, 0.4), metallic=1.0, roughness=0.2),
    "clear coat": _preview(
        diffuseColor=Gf.Vec3f(0.05, 0.1, 0.4), roughness=0.7, clearcoat=1.0, clearcoatRoughness=0.05
    ),
    "transparent": _preview(diffuseColor=Gf.Vec3f(0.4, 0.6, 0.7), roughness=0.1, opacity=0.2),
    "emission": _preview(diffuseColor=Gf.Vec3f(0, 0, 0), emissiveColor=Gf.Vec3f(1.4, 0.7, 0.2), roughness=0.6),
    "texture": _textured("checks.png", _checks(), roughness=0.5),
    "UDIM set": _textured("checks.<UDIM>.png", _checks(squares=4), roughness=0.5),
    "cut-out": _textured("holes.png", _checks(alpha=True), roughness=0.5, opacityThreshold=0.5),
    "normal map": _bumped,
    "specular workflow": _preview(
        diffuseColor=Gf.Vec3f(0.1, 0.1, 0.1),
        useSpecularWorkflow=1,
        specularColor=Gf.Vec3f(0.1, 0.5, 0.3),
        roughness=0.25,
    ),
    "MaterialX standard_surface, by noise": _by_materialx("marble"),
    "MaterialX open_pbr_surface, with a coat": _by_materialx("lacquer"),
    "MaterialX gltf_pbr, by cells": _by_materialx("hammered"),
    "MaterialX glass": _by_materialx("glass"),
    "displayColor alone": lambda stage, path, folder: UsdGeom.Gprim(ball(stage, path)).CreateDisplayColorAttr(
        [(0.3, 0.5, 0.1)]
    ),
}
