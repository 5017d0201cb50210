"""Generated stages of any size: meshes, instances and lights on a square field, with a camera in its middle that moves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, Vt

from render.lab.bench.scale.plan import SceneSize
from render.model.arrays import DoubleArray, FloatArray
from render.stage.geometry.polygons import Polygons, compute_normals, fan

CAMERA = "/World/camera"
FRAMES = (1.0, 24.0)
_FIELD_M, _MATERIALS = 60.0, 8
_MESH_ATTRIBUTES = (
    ("points", Sdf.ValueTypeNames.Point3fArray),
    ("normals", Sdf.ValueTypeNames.Normal3fArray),
    ("faceVertexCounts", Sdf.ValueTypeNames.IntArray),
    ("faceVertexIndices", Sdf.ValueTypeNames.IntArray),
)
_BLADE = ((-0.04, 0, 0), (0.04, 0, 0), (0, 0, 0.05), (0.01, 0.4, 0.02))
_BLADE_FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))


def write_stage(folder: Path, size: SceneSize) -> Path:
    """Write a stage.

    Args:
        folder: existing folder.
        size: number of its parts; meshes are grids, so that the number of triangles is met within a few per cent, and is
            at least four for each mesh.

    Returns:
        The stage's file.
    """
    stage = Usd.Stage.CreateNew(str(folder / "scale.usdc"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    stage.SetStartTimeCode(FRAMES[0])
    stage.SetEndTimeCode(FRAMES[1])
    random = np.random.default_rng(7)
    looks = [_write_material(stage, i) for i in range(_MATERIALS)]
    _write_floor(stage)
    _write_meshes(stage, size, looks, random)
    if size.instances:
        _write_instances(stage, size.instances, random)
    _write_natives(stage, size.natives, random)
    _write_movers(stage, size.movers, random)
    _write_lights(stage, size.lights)
    _write_camera(stage)
    stage.Save()
    return folder / "scale.usdc"


def _places(count: int) -> tuple[DoubleArray, float]:
    """Centres ``(count, 2)`` of the cells of a square grid over the field, metres, and the width of a cell."""
    side = int(np.ceil(np.sqrt(count)))
    cell_m = _FIELD_M / side
    rows, columns = np.divmod(np.arange(count), side)
    return (np.stack([columns, rows], axis=1) + 0.5) * cell_m - _FIELD_M / 2, cell_m


def _write_material(stage: Usd.Stage, number: int) -> UsdShade.Material:
    material = UsdShade.Material.Define(stage, f"/World/looks/look{number}")
    shader = UsdShade.Shader.Define(stage, f"/World/looks/look{number}/surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    hue = 2 * np.pi * number / _MATERIALS
    colour = Gf.Vec3f(*(float(0.5 + 0.35 * np.cos(hue + turn)) for turn in (0.0, 2.1, 4.2)))
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(colour)
    shader.CreateInput("roughness", Sdf.ValueTypeNames.Float).Set(0.3 + 0.08 * number)
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    return material


def _write_floor(stage: Usd.Stage) -> None:
    half = 2 * _FIELD_M
    floor = UsdGeom.Mesh.Define(stage, "/World/floor")
    floor.CreatePointsAttr([Gf.Vec3f(x, 0, z) for x, z in ((-half, half), (half, half), (half, -half), (-half, -half))])
    floor.CreateFaceVertexCountsAttr([4])
    floor.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    floor.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)


def _write_meshes(
    stage: Usd.Stage, size: SceneSize, looks: list[UsdShade.Material], random: np.random.Generator
) -> None:
    """Write bumpy balls, each on the floor of its cell."""
    quads = max(2.0, size.triangles / size.prims / 2)
    around = max(2 if quads < 6 else 3, round(np.sqrt(2 * quads)))
    along = max(1, round(quads / around))
    faces = Vt.IntArray.FromNumpy(_grid_faces(around, along))
    counts = Vt.IntArray.FromNumpy(np.full(around * along, 4, np.int32))
    places, cell_m = _places(size.prims)
    stage.DefinePrim("/World/meshes")
    parent = stage.GetRootLayer().GetPrimAtPath("/World/meshes")
    with Sdf.ChangeBlock():  # composing each prim as it comes would take longer than all that is measured
        for i, (x, z) in enumerate(places):
            radius_m = cell_m * float(random.uniform(0.2, 0.4))
            points = _ball(around, along, radius_m, random) + np.array([x, radius_m, z])
            mesh = Sdf.PrimSpec(parent, f"mesh{i}", Sdf.SpecifierDef, "Mesh")
            mesh.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=["MaterialBindingAPI"]))
            _set_plain(mesh)
            values = (
                *map(Vt.Vec3fArray.FromNumpy, (points.astype(np.float32), _normals(points, faces))),
                counts,
                faces,
            )
            for (name, kind), value in zip(_MESH_ATTRIBUTES, values, strict=True):
                Sdf.AttributeSpec(mesh, name, kind).default = value
            binding = Sdf.RelationshipSpec(mesh, "material:binding", custom=False)
            binding.targetPathList.explicitItems = [looks[i % len(looks)].GetPath()]


def _normals(points: DoubleArray, faces: Vt.IntArray) -> FloatArray:
    """Smooth normals ``(n, 3)`` of quads."""
    corners = np.array(faces, np.int32)
    polygons = Polygons(points.astype(np.float32), np.full(len(corners) // 4, 4, np.int32), corners, smooth=True)
    return compute_normals(polygons, fan(polygons)).values


def _ball(around: int, along: int, radius_m: float, random: np.random.Generator) -> DoubleArray:
    """Points ``((along + 1) · around, 3)`` of a ball with waves on it, metres."""
    turn = np.linspace(0, 2 * np.pi, around, endpoint=False)[None]
    height = np.linspace(0, np.pi, along + 1)[:, None]
    phases = random.uniform(0, 2 * np.pi, 3)
    waves = (
        1 + 0.08 * np.sin(5 * turn + phases[0]) * np.sin(4 * height + phases[1]) + 0.03 * np.sin(17 * height + 9 * turn)
    )
    r = radius_m * waves
    x, y, z = r * np.sin(height) * np.cos(turn), r * np.cos(height), r * np.sin(height) * np.sin(turn)
    return np.stack([x, np.broadcast_to(y, x.shape), z], axis=-1).reshape(-1, 3)


def _grid_faces(around: int, along: int) -> np.ndarray[tuple[int], np.dtype[np.int32]]:
    row, column = np.divmod(np.arange(around * along), around)
    after = (column + 1) % around
    corners = [row * around + column, row * around + after, (row + 1) * around + after, (row + 1) * around + column]
    return np.stack(corners, axis=1).astype(np.int32).ravel()


def _write_instances(stage: Usd.Stage, count: int, random: np.random.Generator) -> None:
    """Write tetrahedra all over the field."""
    instancer = UsdGeom.PointInstancer.Define(stage, "/World/blades")
    instancer.CreatePrototypesRel().AddTarget(_write_blade(stage, "/World/blades/prototypes/blade"))
    positions = _scatter(count, random).astype(np.float32)
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(positions))
    instancer.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy(np.zeros(count, np.int32)))


def _write_blade(stage: Usd.Stage, path: str) -> Sdf.Path:
    """Write a tetrahedron; returns its path."""
    blade = UsdGeom.Mesh.Define(stage, path)
    blade.CreatePointsAttr([Gf.Vec3f(*point) for point in _BLADE])
    blade.CreateFaceVertexCountsAttr([3] * len(_BLADE_FACES))
    blade.CreateFaceVertexIndicesAttr([i for face in _BLADE_FACES for i in face])
    blade.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    blade.CreateDisplayColorAttr([Gf.Vec3f(0.2, 0.5, 0.1)])
    return blade.GetPath()


def _scatter(count: int, random: np.random.Generator) -> DoubleArray:
    """Points ``(count, 3)`` all over the field, metres."""
    places = random.uniform(-_FIELD_M / 2, _FIELD_M / 2, (count, 2))
    return np.stack([places[:, 0], np.zeros(count), places[:, 1]], axis=1)


def _write_natives(stage: Usd.Stage, count: int, random: np.random.Generator) -> None:
    """Write native instances of a tetrahedron all over the field."""
    stage.CreateClassPrim("/Blade")
    _write_blade(stage, "/Blade/blade")
    parent = _group(stage, "/World/natives")
    with Sdf.ChangeBlock():
        for number, place in enumerate(_scatter(count, random)):
            prim = Sdf.PrimSpec(parent, f"blade{number}", Sdf.SpecifierDef, "Xform")
            prim.SetInfo("instanceable", True)
            prim.inheritPathList.prependedItems = ["/Blade"]
            _translate(prim).default = Gf.Vec3d(*place)


def _write_movers(stage: Usd.Stage, count: int, random: np.random.Generator) -> None:
    """Write tetrahedra all over the field that go up over the frames, each at its own speed."""
    values = {
        name: stage.GetAttributeAtPath(_write_blade(stage, "/Mover").AppendProperty(name)).Get()
        for name, _ in _MESH_ATTRIBUTES
    }
    stage.RemovePrim("/Mover")
    parent = _group(stage, "/World/movers")
    with Sdf.ChangeBlock():
        for number, (place, speed) in enumerate(zip(_scatter(count, random), random.uniform(0, 1, count), strict=True)):
            mesh = Sdf.PrimSpec(parent, f"blade{number}", Sdf.SpecifierDef, "Mesh")
            _set_plain(mesh)
            for name, kind in _MESH_ATTRIBUTES:
                if values[name] is not None:
                    Sdf.AttributeSpec(mesh, name, kind).default = values[name]
            track = _translate(mesh).path
            for time, height in zip(FRAMES, (0.0, speed), strict=True):
                stage.GetRootLayer().SetTimeSample(track, time, Gf.Vec3d(place[0], height, place[2]))


def _set_plain(mesh: Sdf.PrimSpec) -> None:
    """Have a mesh drawn by its own faces, so that its triangles are those that were asked for."""
    scheme = Sdf.AttributeSpec(mesh, "subdivisionScheme", Sdf.ValueTypeNames.Token, Sdf.VariabilityUniform)
    scheme.default = "none"


def _group(stage: Usd.Stage, path: str) -> Sdf.PrimSpec:
    stage.DefinePrim(path)
    return stage.GetRootLayer().GetPrimAtPath(path)


def _translate(prim: Sdf.PrimSpec) -> Sdf.AttributeSpec:
    """Add a translation to a prim, without a value."""
    order = Sdf.AttributeSpec(prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
    order.default = Vt.TokenArray(["xformOp:translate"])
    return Sdf.AttributeSpec(prim, "xformOp:translate", Sdf.ValueTypeNames.Double3)


def _write_lights(stage: Usd.Stage, count: int) -> None:
    """Write lights of one power in all above the field."""
    for i, (x, z) in enumerate(_places(count)[0]):
        light = UsdLux.SphereLight.Define(stage, f"/World/lights/light{i}")
        light.CreateRadiusAttr(0.15)
        light.CreateIntensityAttr(40_000.0 / count)
        UsdLux.ShadowAPI.Apply(light.GetPrim())
        UsdGeom.Xformable(light).AddTranslateOp().Set(Gf.Vec3d(float(x) + 0.7, 7.0, float(z) - 0.7))


def _write_camera(stage: Usd.Stage) -> None:
    camera = UsdGeom.Camera.Define(stage, CAMERA)
    camera.CreateFocalLengthAttr(0.35)
    camera.CreateHorizontalApertureAttr(0.36)
    camera.CreateVerticalApertureAttr(0.2025)
    camera.CreateFStopAttr(2.0)
    camera.CreateFocusDistanceAttr(9.0)
    camera.CreateClippingRangeAttr(Gf.Vec2f(0.1, 400))
    track = UsdGeom.Xformable(camera).AddTranslateOp()
    for time, x in zip(FRAMES, (-0.6, 0.6), strict=True):
        track.Set(Gf.Vec3d(x, 2.2, 4.0), time)
