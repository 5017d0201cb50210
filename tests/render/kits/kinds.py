"""Stages of each kind of geometry, material and light, for the page of all kinds and its tests."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdSkel, Vt

from tests.render.kits.stages import add_material, add_mesh, add_texture, bind, set_primvar, write_picture

T = Sdf.ValueTypeNames

Author = Callable[[Usd.Stage, str, Path], None]

CUBE = [(x, y, z) for x in (-0.8, 0.8) for y in (0, 1.6) for z in (-0.8, 0.8)]
FACES = [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3]


def _points(values: object) -> Vt.Vec3fArray:
    return Vt.Vec3fArray.FromNumpy(np.asarray(values, np.float32))


def _cube(stage: Usd.Stage, path: str, scheme: str = "none") -> UsdGeom.Mesh:
    return add_mesh(stage, path, CUBE, [4] * 6, FACES, scheme)


def _ball(stage: Usd.Stage, path: str) -> Usd.Prim:
    """Ball of latitude and longitude, with texture coordinates."""
    columns, rows = 48, 24
    around, up = np.meshgrid(np.linspace(0, 2 * np.pi, columns + 1), np.linspace(0, np.pi, rows + 1))
    points = np.stack([np.sin(up) * np.sin(around), -np.cos(up), np.sin(up) * np.cos(around)], axis=2) * 0.8 + (
        0,
        0.8,
        0,
    )
    corner = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    corners = np.stack([corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]], axis=2).reshape(-1)
    mesh = add_mesh(stage, path, points.reshape(-1, 3), [4] * (columns * rows), corners)
    st = np.stack([around / (2 * np.pi), up / np.pi], axis=2).reshape(-1, 2).astype(np.float32)
    set_primvar(mesh.GetPrim(), "st", T.TexCoord2fArray, "vertex", Vt.Vec2fArray.FromNumpy(st))
    mesh.CreateNormalsAttr(_points((points - (0, 0.8, 0)).reshape(-1, 3)))
    mesh.SetNormalsInterpolation("vertex")
    return mesh.GetPrim()


def _polygons(stage: Usd.Stage, path: str, folder: Path) -> None:
    colors = np.array(CUBE) * (0.5, 0.5, 0.5) + (0.5, 0.1, 0.5)
    prim = _cube(stage, path).GetPrim()
    set_primvar(prim, "displayColor", T.Color3fArray, "vertex", Vt.Vec3fArray.FromNumpy(colors.astype(np.float32)))


def _subdivided(stage: Usd.Stage, path: str, folder: Path) -> None:
    _cube(stage, path, "catmullClark")


def _creased(stage: Usd.Stage, path: str, folder: Path) -> None:
    mesh = _cube(stage, path, "catmullClark")
    mesh.CreateCreaseIndicesAttr([2, 3, 7, 6, 2])
    mesh.CreateCreaseLengthsAttr([5])
    mesh.CreateCreaseSharpnessesAttr([10.0])


def _hair(stage: Usd.Stage, path: str, folder: Path) -> None:
    random = np.random.default_rng(3)
    roots = random.uniform(-0.8, 0.8, (150, 2))
    points = [
        (x + step * lean[0], 0.5 * step, z + step * lean[1])
        for (x, z), lean in zip(roots, random.normal(0, 0.12, (150, 2)), strict=True)
        for step in range(4)
    ]
    curves = UsdGeom.BasisCurves.Define(stage, path)
    curves.CreatePointsAttr(_points(points))
    curves.CreateCurveVertexCountsAttr([4] * 150)
    curves.CreateTypeAttr("cubic")
    curves.CreateBasisAttr("bspline")
    curves.CreateWrapAttr("pinned")
    curves.CreateWidthsAttr([0.05, 0.05, 0.03, 0.0] * 150)
    curves.SetWidthsInterpolation("vertex")
    curves.CreateDisplayColorAttr([(0.5, 0.25, 0.08)])


def _ribbons(stage: Usd.Stage, path: str, folder: Path) -> None:
    angles = np.linspace(0, 4 * np.pi, 25)
    points = np.stack([0.6 * np.cos(angles), angles / 8, 0.6 * np.sin(angles)], axis=1)
    curves = UsdGeom.BasisCurves.Define(stage, path)
    curves.CreatePointsAttr(_points(points))
    curves.CreateCurveVertexCountsAttr([25])
    curves.CreateTypeAttr("cubic")
    curves.CreateBasisAttr("catmullRom")
    curves.CreateWrapAttr("pinned")
    curves.CreateWidthsAttr([0.25])
    curves.SetWidthsInterpolation("constant")
    curves.CreateNormalsAttr(_points(points * (1, 0, 1)))
    curves.SetNormalsInterpolation("vertex")
    curves.CreateDisplayColorAttr([(0.1, 0.5, 0.3)])


def _nurbs_curve(stage: Usd.Stage, path: str, folder: Path) -> None:
    curve = UsdGeom.NurbsCurves.Define(stage, path)
    root = float(np.sqrt(0.5))
    ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    curve.CreatePointsAttr(_points([(0.7 * x, 0.8 + 0.7 * y, 0) for x, y in ring]))
    curve.CreatePointWeightsAttr([1.0 if number % 2 == 0 else root for number in range(9)])
    curve.CreateCurveVertexCountsAttr([9])
    curve.CreateOrderAttr([3])
    curve.CreateKnotsAttr([0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4])
    curve.CreateWidthsAttr([0.3])
    curve.SetWidthsInterpolation("constant")
    curve.CreateDisplayColorAttr([(0.6, 0.1, 0.1)])


def _patch(stage: Usd.Stage, path: str, folder: Path) -> None:
    patch = UsdGeom.NurbsPatch.Define(stage, path)
    heights = np.array([[0.3, 1.0, 0.2, 0.8], [1.2, 0.1, 1.4, 0.3], [0.2, 1.3, 0.2, 1.2], [0.8, 0.2, 1.1, 0.3]])
    patch.CreatePointsAttr(
        _points([(-0.9 + 0.6 * u, heights[v, u], -0.9 + 0.6 * v) for v in range(4) for u in range(4)])
    )
    for order, count, knots in (
        (patch.CreateUOrderAttr, patch.CreateUVertexCountAttr, patch.CreateUKnotsAttr),
        (patch.CreateVOrderAttr, patch.CreateVVertexCountAttr, patch.CreateVKnotsAttr),
    ):
        order(4)
        count(4)
        knots([0.0] * 4 + [1.0] * 4)
    patch.CreateDisplayColorAttr([(0.2, 0.35, 0.7)])


def _balls(stage: Usd.Stage, path: str, folder: Path) -> None:
    random = np.random.default_rng(5)
    points = UsdGeom.Points.Define(stage, path)
    points.CreatePointsAttr(_points(random.uniform((-0.9, 0.1, -0.9), (0.9, 1.6, 0.9), (80, 3))))
    points.CreateWidthsAttr(Vt.FloatArray.FromNumpy(random.uniform(0.08, 0.4, 80).astype(np.float32)))
    colors = random.uniform(0.1, 0.9, (80, 3)).astype(np.float32)
    set_primvar(points.GetPrim(), "displayColor", T.Color3fArray, "vertex", Vt.Vec3fArray.FromNumpy(colors))


def _tetrahedra(stage: Usd.Stage, path: str, folder: Path) -> None:
    mesh = UsdGeom.TetMesh.Define(stage, path)
    mesh.CreatePointsAttr(_points([(-0.9, 0, -0.6), (0.9, 0, -0.6), (0, 0, 0.9), (0, 1.2, 0), (0.9, 1.5, 0.8)]))
    mesh.CreateTetVertexIndicesAttr([Gf.Vec4i(0, 1, 2, 3), Gf.Vec4i(1, 2, 3, 4)])
    mesh.CreateDisplayColorAttr([(0.6, 0.5, 0.1)])


def _implicit(stage: Usd.Stage, path: str, folder: Path) -> None:
    UsdGeom.Xform.Define(stage, path)
    shapes = (UsdGeom.Sphere, UsdGeom.Cone, UsdGeom.Cylinder, UsdGeom.Capsule)
    for number, shape in enumerate(shapes):
        prim = shape.Define(stage, f"{path}/part_{number}")
        prim.AddTranslateOp().Set((0.55 * (-1) ** number, 0.45, 0.55 * (-1) ** (number // 2)))
        prim.AddScaleOp().Set((0.35, 0.35, 0.35))
        prim.CreateDisplayColorAttr([tuple(np.eye(3)[number % 3] * 0.5 + 0.15)])


def _instancer(stage: Usd.Stage, path: str, folder: Path) -> None:
    instancer = UsdGeom.PointInstancer.Define(stage, path)
    ball = UsdGeom.Sphere.Define(stage, f"{path}/ball")
    ball.CreateRadiusAttr(0.12)
    instancer.CreatePrototypesRel().SetTargets([ball.GetPath()])
    places = [(0.4 * x, 0.2 + 0.4 * y, 0.4 * z) for x in (-2, -1, 0, 1, 2) for y in range(4) for z in (-2, -1, 0, 1, 2)]
    instancer.CreatePositionsAttr(_points(places))
    instancer.CreateProtoIndicesAttr([0] * len(places))
    colors = (np.array(places) * 0.4 + (0.4, 0.1, 0.4)).astype(np.float32)
    set_primvar(instancer.GetPrim(), "displayColor", T.Color3fArray, "vertex", Vt.Vec3fArray.FromNumpy(colors))


def _skinned(stage: Usd.Stage, path: str, folder: Path) -> None:
    root = UsdSkel.Root.Define(stage, path)
    skeleton = UsdSkel.Skeleton.Define(stage, f"{path}/skeleton")
    skeleton.CreateJointsAttr(["low", "low/high"])
    up = Gf.Matrix4d(1).SetTranslate(Gf.Vec3d(0, 0.8, 0))
    skeleton.CreateBindTransformsAttr([Gf.Matrix4d(1), up])
    skeleton.CreateRestTransformsAttr([Gf.Matrix4d(1), up])
    animation = UsdSkel.Animation.Define(stage, f"{path}/animation")
    animation.CreateJointsAttr(["low", "low/high"])
    animation.CreateTranslationsAttr([(0, 0, 0), (0, 0.8, 0)])
    animation.CreateRotationsAttr([Gf.Quatf(1), Gf.Quatf(Gf.Rotation((0, 0, 1), 60).GetQuat())])
    animation.CreateScalesAttr([(1, 1, 1), (1, 1, 1)])
    binding = UsdSkel.BindingAPI.Apply(root.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    rings = [(0.3 * np.cos(a), y, 0.3 * np.sin(a)) for y in np.linspace(0, 1.6, 9) for a in np.arange(8) * np.pi / 4]
    corners = [
        n
        for ring in range(8)
        for a in range(8)
        for n in (8 * ring + a, 8 * ring + 8 + a, 8 * ring + 8 + (a + 1) % 8, 8 * ring + (a + 1) % 8)
    ]
    mesh = add_mesh(stage, f"{path}/arm", rings, [4] * 64, corners, "catmullClark")
    skin = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    skin.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    high = np.clip((np.array(rings)[:, 1] - 0.5) / 0.6, 0, 1)
    skin.CreateJointIndicesPrimvar(False, 2).Set(Vt.IntArray([0, 1] * len(rings)))
    skin.CreateJointWeightsPrimvar(False, 2).Set(
        Vt.FloatArray.FromNumpy(np.stack([1 - high, high], 1).ravel().astype(np.float32))
    )
    mesh.CreateDisplayColorAttr([(0.5, 0.3, 0.25)])


def _stand_in(stage: Usd.Stage, path: str, folder: Path) -> None:
    model = UsdGeom.Xform.Define(stage, path)
    Usd.ModelAPI(model.GetPrim().GetParent()).SetKind("group")
    Usd.ModelAPI(model).SetKind("component")
    api = UsdGeom.ModelAPI.Apply(model.GetPrim())
    api.CreateModelDrawModeAttr("bounds")
    api.CreateModelDrawModeColorAttr((0.9, 0.5, 0.05))
    sphere = UsdGeom.Sphere.Define(stage, f"{path}/ball")
    sphere.CreateRadiusAttr(0.8)
    sphere.AddTranslateOp().Set((0, 0.8, 0))


def _splats(stage: Usd.Stage, path: str, folder: Path) -> None:
    random = np.random.default_rng(7)
    directions = random.normal(size=(3000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    prim = stage.DefinePrim(path, "ParticleField3DGaussianSplat")
    prim.GetAttribute("positions").Set(_points(0.75 * directions + (0, 0.8, 0)))
    prim.GetAttribute("scales").Set(_points(np.full((3000, 3), 0.04)))
    prim.GetAttribute("orientations").Set(Vt.QuatfArray([Gf.Quatf(1)] * 3000))
    prim.GetAttribute("opacities").Set(Vt.FloatArray.FromNumpy(np.full(3000, 0.6, np.float32)))
    colors = (directions * 0.5 + 0.5 - 0.5) / 0.28209479
    prim.GetAttribute("radiance:sphericalHarmonicsDegree").Set(0)
    prim.GetAttribute("radiance:sphericalHarmonicsCoefficients").Set(_points(colors))


def _displaced(stage: Usd.Stage, path: str, folder: Path) -> None:
    x = np.arange(64) / 64 * 2 * np.pi
    waves = 127 + 60 * (np.sin(4 * x)[:, None] + np.sin(4 * x)[None])
    write_picture(folder / "waves.png", np.repeat(waves[..., None], 3, axis=2).astype(np.uint8))
    prim = _ball(stage, path)
    UsdGeom.Mesh(prim).CreateSubdivisionSchemeAttr("catmullClark")
    shader = add_material(stage, f"{path}_look", diffuseColor=Gf.Vec3f(0.5, 0.25, 0.1), roughness=0.4)
    texture = add_texture(stage, f"{path}_look/waves", "./waves.png")
    texture.CreateInput("sourceColorSpace", T.Token).Set("raw")
    texture.CreateInput("scale", T.Float4).Set((0.25, 0.25, 0.25, 1))
    shader.CreateInput("displacement", T.Float).ConnectToSource(texture.CreateOutput("r", T.Float))
    material = UsdShade.Material(stage.GetPrimAtPath(f"{path}_look"))
    material.CreateDisplacementOutput().ConnectToSource(shader.CreateOutput("displacement", T.Token))
    bind(prim, f"{path}_look")


GEOMETRY: dict[str, Author] = {
    "polygons, with a colour for each point": _polygons,
    "subdivision surface": _subdivided,
    "subdivision surface with a crease": _creased,
    "curves as tubes": _hair,
    "curves as ribbons": _ribbons,
    "NURBS curve": _nurbs_curve,
    "NURBS patch": _patch,
    "points": _balls,
    "tetrahedra": _tetrahedra,
    "implicit shapes": _implicit,
    "point instancer": _instancer,
    "skinned mesh": _skinned,
    "draw mode": _stand_in,
    "Gaussian splats": _splats,
    "displacement": _displaced,
}


def _preview(**inputs: object) -> Author:
    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        add_material(stage, f"{path}_look", **inputs)
        bind(_ball(stage, path), f"{path}_look")

    return author


def _textured(file: str, pixels: np.ndarray, **inputs: object) -> Author:
    """Ball whose diffuse colour, or opacity where the pixels have an alpha, is a texture; UDIM sets are two tiles wide."""

    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        for number, part in enumerate(np.split(pixels, 2, axis=1) if "<UDIM>" in file else [pixels]):
            write_picture(folder / file.replace("<UDIM>", str(1001 + number)), np.ascontiguousarray(part))
        prim = _ball(stage, path)
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
    bind(_ball(stage, path), f"{path}_look")


def _by_materialx(name: str) -> Author:
    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        (folder / "kinds.mtlx").write_text(DOCUMENT)
        if not stage.GetPrimAtPath("/MaterialX"):
            stage.DefinePrim("/MaterialX", "Scope").GetReferences().AddReference("./kinds.mtlx", "/MaterialX")
        binding = UsdShade.MaterialBindingAPI.Apply(_ball(stage, path))
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
    "displayColor alone": lambda stage, path, folder: UsdGeom.Gprim(_ball(stage, path)).CreateDisplayColorAttr(
        [(0.3, 0.5, 0.1)]
    ),
}


def _booth(stage: Usd.Stage, path: str) -> str:
    """Floor, back and two sides with a ball; returns the path of the whole."""
    UsdGeom.Xform.Define(stage, path)
    low, high = (-1.4, 0.0, -1.4), (1.4, 2.4, 1.4)
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    walls = add_mesh(stage, f"{path}/walls", corners, [4] * 4, [0, 1, 5, 4, 0, 4, 6, 2, 0, 2, 3, 1, 4, 5, 7, 6])
    walls.CreateDoubleSidedAttr(True)
    walls.CreateDisplayColorAttr([(0.5, 0.5, 0.5)])
    ball = UsdGeom.Sphere.Define(stage, f"{path}/ball")
    ball.CreateRadiusAttr(0.4)
    ball.AddTranslateOp().Set((0.1, 0.4, 0.1))
    ball.CreateDisplayColorAttr([(0.6, 0.6, 0.6)])
    return path


def _lit_by(
    kind: type, place: tuple[float, ...], turn: tuple[float, ...], apis: tuple[type, ...] = (), **values: object
) -> Author:
    """Booth with a light. ``values`` are its properties, with ``_`` for ``:``."""

    def author(stage: Usd.Stage, path: str, folder: Path) -> None:
        _booth(stage, path)
        light = kind.Define(stage, f"{path}/light")
        light.AddTranslateOp().Set(place)
        light.AddRotateXYZOp().Set(turn)
        for api in apis:
            api.Apply(light.GetPrim())
        for name, value in values.items():
            light.GetPrim().GetAttribute(name.replace("_", ":")).Set(value)

    return author


def _pictured(stage: Usd.Stage, path: str, folder: Path) -> None:
    stripes = np.zeros((64, 64, 3), np.uint8)
    stripes[:, :22], stripes[:, 22:43], stripes[:, 43:] = (255, 30, 30), (30, 255, 30), (40, 40, 255)
    write_picture(folder / "stripes.png", stripes)
    _lit_by(UsdLux.RectLight, (0, 1.8, 0.9), (-60, 0, 0), inputs_intensity=14.0, inputs_width=1.6, inputs_height=0.5)(
        stage, path, folder
    )
    UsdLux.RectLight(stage.GetPrimAtPath(f"{path}/light")).CreateTextureFileAttr("./stripes.png")


def _mesh_light(stage: Usd.Stage, path: str, folder: Path) -> None:
    _booth(stage, path)
    points = [(-0.3, 1.5, 0.2), (0.3, 1.5, 0.2), (0, 1.5, -0.4), (0, 2.0, 0)]
    mesh = add_mesh(stage, f"{path}/light", points, [3] * 4, [0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3])
    UsdLux.MeshLightAPI.Apply(mesh.GetPrim())
    UsdLux.LightAPI(mesh.GetPrim()).CreateIntensityAttr(6.0)


def _profiled(stage: Usd.Stage, path: str, folder: Path) -> None:
    candela = " ".join(str(value) for value in (100, 700, 60, 900, 20, 0, 0))
    (folder / "lamp.ies").write_text(
        f"IESNA:LM-63-2002\nTILT=NONE\n1 1000 1 7 1 1 2 0 0 0\n1 1 100\n0 15 30 45 60 75 90\n0\n{candela}\n"
    )
    _lit_by(
        UsdLux.SphereLight, (0, 2.0, 0.3), (-90, 0, 0), (UsdLux.ShapingAPI,), inputs_intensity=0.5, inputs_radius=0.05
    )(stage, path, folder)
    UsdLux.ShapingAPI(stage.GetPrimAtPath(f"{path}/light")).CreateShapingIesFileAttr("./lamp.ies")


LIGHTS: dict[str, Author] = {
    "distant light": _lit_by(
        UsdLux.DistantLight, (0, 0, 0), (-50, 35, 0), inputs_intensity=2.0, inputs_normalize=True, inputs_angle=1.0
    ),
    "distant light of 20°": _lit_by(
        UsdLux.DistantLight, (0, 0, 0), (-50, 35, 0), inputs_intensity=2.0, inputs_normalize=True, inputs_angle=20.0
    ),
    "small sphere light": _lit_by(
        UsdLux.SphereLight, (-0.6, 1.7, 0.7), (0, 0, 0), inputs_intensity=300.0, inputs_radius=0.05
    ),
    "large sphere light": _lit_by(
        UsdLux.SphereLight, (-0.6, 1.7, 0.7), (0, 0, 0), inputs_intensity=8.0, inputs_radius=0.3
    ),
    "disk light": _lit_by(UsdLux.DiskLight, (0, 2.2, 0.4), (-80, 0, 0), inputs_intensity=8.0, inputs_radius=0.4),
    "rect light": _lit_by(
        UsdLux.RectLight, (0, 2.2, 0.4), (-80, 0, 0), inputs_intensity=8.0, inputs_width=1.6, inputs_height=0.3
    ),
    "rect light with a texture": _pictured,
    "cylinder light": _lit_by(
        UsdLux.CylinderLight, (0, 1.6, 0.5), (0, 0, 20), inputs_intensity=14.0, inputs_length=1.6, inputs_radius=0.04
    ),
    "mesh light": _mesh_light,
    "cone": _lit_by(
        UsdLux.SphereLight,
        (0, 2.2, 1.0),
        (-65, 0, 0),
        (UsdLux.ShapingAPI,),
        inputs_intensity=300.0,
        inputs_radius=0.06,
        inputs_shaping_cone_angle=22.0,
        inputs_shaping_cone_softness=0.3,
    ),
    "IES profile": _profiled,
    "colour temperature": _lit_by(
        UsdLux.SphereLight,
        (-0.6, 1.7, 0.7),
        (0, 0, 0),
        inputs_intensity=8.0,
        inputs_radius=0.3,
        inputs_enableColorTemperature=True,
        inputs_colorTemperature=2700.0,
    ),
    "coloured shadow": _lit_by(
        UsdLux.DistantLight,
        (0, 0, 0),
        (-50, 35, 0),
        (UsdLux.ShadowAPI,),
        inputs_intensity=2.0,
        inputs_normalize=True,
        inputs_shadow_color=Gf.Vec3f(0.5, 0.05, 0.05),
    ),
    "shadow:distance": _lit_by(
        UsdLux.DistantLight,
        (0, 0, 0),
        (-50, 35, 0),
        (UsdLux.ShadowAPI,),
        inputs_intensity=2.0,
        inputs_normalize=True,
        inputs_shadow_distance=0.6,
    ),
}


def kind_stage(file: Path, author: Author, *, booth: bool = False) -> Usd.Stage:
    """Stage with one kind ``/world/kind``, and a camera ``/camera`` that sees it.

    Args:
        file: layer to write; textures come beside it.
        author: authors the kind.
        booth: whether it brings a light of its own; else a sky and a sun light it, on a floor.
    """
    stage = Usd.Stage.CreateNew(str(file))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Y")
    UsdGeom.Xform.Define(stage, "/world")
    author(stage, "/world/kind", file.parent)
    camera = UsdGeom.Camera.Define(stage, "/camera")
    camera.CreateFocalLengthAttr(0.5)  # tenths of a metre
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.27)
    camera.CreateFStopAttr(1.4)
    camera.CreateFocusDistanceAttr(4.9)
    camera.CreateClippingRangeAttr((0.1, 100))
    camera.AddTranslateOp().Set((0, 2.2, 5.0))
    camera.AddRotateXYZOp().Set((-16, 0, 0))
    if not booth:
        floor = add_mesh(stage, "/floor", [(-20, 0, 10), (20, 0, 10), (20, 0, -20), (-20, 0, -20)])
        floor.CreateDisplayColorAttr([(0.35, 0.35, 0.37)])
        UsdLux.DomeLight.Define(stage, "/sky").CreateIntensityAttr(0.5)
        sun = UsdLux.DistantLight.Define(stage, "/sun")
        sun.CreateIntensityAttr(2.0)
        sun.CreateNormalizeAttr(True)
        sun.CreateAngleAttr(4.0)
        UsdGeom.Xformable(sun).AddRotateXYZOp().Set((-50, -30, 0))
    stage.Save()
    return stage
