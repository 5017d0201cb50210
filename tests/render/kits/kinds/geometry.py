"""Each kind of geometry."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Usd, UsdGeom, UsdShade, UsdSkel, Vt

from tests.render.kits.kinds.parts import Author, T, as_points, ball
from tests.render.kits.stages import add_material, add_mesh, add_texture, bind, set_primvar, write_picture

CUBE = [(x, y, z) for x in (-0.8, 0.8) for y in (0, 1.6) for z in (-0.8, 0.8)]
FACES = [0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3]


def _cube(stage: Usd.Stage, path: str, scheme: str = "none") -> UsdGeom.Mesh:
    return add_mesh(stage, path, CUBE, [4] * 6, FACES, scheme)


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
    curves.CreatePointsAttr(as_points(points))
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
    curves.CreatePointsAttr(as_points(points))
    curves.CreateCurveVertexCountsAttr([25])
    curves.CreateTypeAttr("cubic")
    curves.CreateBasisAttr("catmullRom")
    curves.CreateWrapAttr("pinned")
    curves.CreateWidthsAttr([0.25])
    curves.SetWidthsInterpolation("constant")
    curves.CreateNormalsAttr(as_points(points * (1, 0, 1)))
    curves.SetNormalsInterpolation("vertex")
    curves.CreateDisplayColorAttr([(0.1, 0.5, 0.3)])


def _nurbs_curve(stage: Usd.Stage, path: str, folder: Path) -> None:
    curve = UsdGeom.NurbsCurves.Define(stage, path)
    root = float(np.sqrt(0.5))
    ring = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    curve.CreatePointsAttr(as_points([(0.7 * x, 0.8 + 0.7 * y, 0) for x, y in ring]))
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
        as_points([(-0.9 + 0.6 * u, heights[v, u], -0.9 + 0.6 * v) for v in range(4) for u in range(4)])
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
    points.CreatePointsAttr(as_points(random.uniform((-0.9, 0.1, -0.9), (0.9, 1.6, 0.9), (80, 3))))
    points.CreateWidthsAttr(Vt.FloatArray.FromNumpy(random.uniform(0.08, 0.4, 80).astype(np.float32)))
    colors = random.uniform(0.1, 0.9, (80, 3)).astype(np.float32)
    set_primvar(points.GetPrim(), "displayColor", T.Color3fArray, "vertex", Vt.Vec3fArray.FromNumpy(colors))


def _tetrahedra(stage: Usd.Stage, path: str, folder: Path) -> None:
    mesh = UsdGeom.TetMesh.Define(stage, path)
    mesh.CreatePointsAttr(as_points([(-0.9, 0, -0.6), (0.9, 0, -0.6), (0, 0, 0.9), (0, 1.2, 0), (0.9, 1.5, 0.8)]))
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
    instancer.CreatePositionsAttr(as_points(places))
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
    prim.GetAttribute("positions").Set(as_points(0.75 * directions + (0, 0.8, 0)))
    prim.GetAttribute("scales").Set(as_points(np.full((3000, 3), 0.04)))
    prim.GetAttribute("orientations").Set(Vt.QuatfArray([Gf.Quatf(1)] * 3000))
    prim.GetAttribute("opacities").Set(Vt.FloatArray.FromNumpy(np.full(3000, 0.6, np.float32)))
    colors = (directions * 0.5 + 0.5 - 0.5) / 0.28209479
    prim.GetAttribute("radiance:sphericalHarmonicsDegree").Set(0)
    prim.GetAttribute("radiance:sphericalHarmonicsCoefficients").Set(as_points(colors))


def _displaced(stage: Usd.Stage, path: str, folder: Path) -> None:
    x = np.arange(64) / 64 * 2 * np.pi
    waves = 127 + 60 * (np.sin(4 * x)[:, None] + np.sin(4 * x)[None])
    write_picture(folder / "waves.png", np.repeat(waves[..., None], 3, axis=2).astype(np.uint8))
    prim = ball(stage, path)
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
