"""displayColor and displayOpacity of every kind of prim, in every interpolation that it has, plain and indexed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom

from render.model.arrays import FloatArray
from render.stage import StageReader
from tests.render.kits.stages import T, add_mesh, codes, new_stage, only_batch, set_primvar

Sizes = dict[str, int]
GRID = [(x, y, 0) for y in range(3) for x in range(3)]
QUADS = [c for y in range(2) for x in range(2) for c in (3 * y + x, 3 * y + x + 1, 3 * y + x + 4, 3 * y + x + 3)]


def mesh(stage: Usd.Stage, scheme: str) -> Sizes:
    add_mesh(stage, "/p", GRID, [4] * 4, QUADS, scheme)
    return {"constant": 1, "uniform": 4, "varying": 9, "vertex": 9, "faceVarying": 16}


def curves(stage: Usd.Stage, kind: str, basis: str) -> Sizes:
    """Two curves of four points and of seven."""
    prim = UsdGeom.BasisCurves.Define(stage, "/p")
    prim.CreateTypeAttr(kind)
    prim.CreateBasisAttr(basis)
    prim.CreateCurveVertexCountsAttr([4, 7])
    prim.CreatePointsAttr([Gf.Vec3f(i, i % 2, 0) for i in range(11)])
    prim.CreateWidthsAttr([0.1])
    prim.SetWidthsInterpolation("constant")
    time = Usd.TimeCode.Default()
    return {
        "constant": 1,
        "uniform": prim.ComputeUniformDataSize(time),
        "varying": prim.ComputeVaryingDataSize(time),
        "vertex": prim.ComputeVertexDataSize(time),
    }


def nurbs_curve(stage: Usd.Stage) -> Sizes:
    prim = UsdGeom.NurbsCurves.Define(stage, "/p")
    prim.CreateCurveVertexCountsAttr([4])
    prim.CreateOrderAttr([4])
    prim.CreateKnotsAttr([0, 0, 0, 0, 1, 1, 1, 1])
    prim.CreatePointsAttr([Gf.Vec3f(i, i % 2, 0) for i in range(4)])
    prim.CreateWidthsAttr([0.1])
    prim.SetWidthsInterpolation("constant")
    return {"constant": 1, "uniform": 1, "varying": 2, "vertex": 4}


def points(stage: Usd.Stage) -> Sizes:
    prim = UsdGeom.Points.Define(stage, "/p")
    prim.CreatePointsAttr([Gf.Vec3f(i, 0, 0) for i in range(3)])
    prim.CreateWidthsAttr([0.5] * 3)
    return {"constant": 1, "uniform": 1, "varying": 3, "vertex": 3, "faceVarying": 3}


def patch(stage: Usd.Stage) -> Sizes:
    """Four points by four of order 3: two spans each way."""
    prim = UsdGeom.NurbsPatch.Define(stage, "/p")
    prim.CreateUVertexCountAttr(4)
    prim.CreateVVertexCountAttr(4)
    for name in ("U", "V"):
        getattr(prim, f"Create{name}OrderAttr")(3)
        getattr(prim, f"Create{name}KnotsAttr")([0, 0, 0, 1, 2, 2, 2])
    prim.CreatePointsAttr([Gf.Vec3f(i % 4, i // 4, 0) for i in range(16)])
    return {"constant": 1, "uniform": 4, "varying": 9, "vertex": 16, "faceVarying": 9}


def tetrahedra(stage: Usd.Stage) -> Sizes:
    prim = UsdGeom.TetMesh.Define(stage, "/p")
    prim.CreatePointsAttr([Gf.Vec3f(*p) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1))])
    prim.CreateTetVertexIndicesAttr([Gf.Vec4i(0, 1, 2, 3)])
    prim.CreateSurfaceFaceVertexIndicesAttr([Gf.Vec3i(*f) for f in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))])
    return {"constant": 1, "varying": 4, "vertex": 4}


def cube(stage: Usd.Stage) -> Sizes:
    UsdGeom.Cube.Define(stage, "/p")
    return {"constant": 1, "uniform": 6, "varying": 8, "vertex": 8, "faceVarying": 24}


KINDS: dict[str, Callable[[Usd.Stage], Sizes]] = {
    "polygons": lambda stage: mesh(stage, "none"),
    "catmullClark": lambda stage: mesh(stage, "catmullClark"),
    "bilinear": lambda stage: mesh(stage, "bilinear"),
    "linear": lambda stage: curves(stage, "linear", "bezier"),
    "bezier": lambda stage: curves(stage, "cubic", "bezier"),
    "bspline": lambda stage: curves(stage, "cubic", "bspline"),
    "catmullRom": lambda stage: curves(stage, "cubic", "catmullRom"),
    "nurbs": nurbs_curve,
    "points": points,
    "patch": patch,
    "tetrahedra": tetrahedra,
    "cube": cube,
}


def colors(build: Callable[[Usd.Stage], Sizes], interpolation: str, *, is_indexed: bool) -> tuple[FloatArray, set[str]]:
    """Colours of a prim with a ramp from 0.2 to 0.8 as its grey and as its opacity, and the findings about it."""
    stage = new_stage()
    size = build(stage)[interpolation]
    ramp = np.linspace(0.2, 0.8, size, dtype=np.float32) if size > 1 else np.array([0.5], np.float32)
    stored = ramp[::-1] if is_indexed else ramp
    prim = stage.GetPrimAtPath("/p")
    for primvar in (
        set_primvar(prim, "displayColor", T.Color3fArray, interpolation, [Gf.Vec3f(float(v)) for v in stored]),
        set_primvar(prim, "displayOpacity", T.FloatArray, interpolation, stored.tolist()),
    ):
        if is_indexed:
            primvar.SetIndices(list(range(size))[::-1])
    reader = StageReader(stage)
    found = only_batch(reader.read(0)).geometry.colors
    assert found is not None
    return found, codes(reader)


@pytest.mark.parametrize(
    ("kind", "interpolation"), [(k, each) for k, make in KINDS.items() for each in make(new_stage())]
)
def test_colours_and_opacities_are_where_they_belong(kind: str, interpolation: str) -> None:
    """Grey and opacity of the same numbers are equal everywhere, with indices as without, and no value is left out."""
    plain, findings = colors(KINDS[kind], interpolation, is_indexed=False)
    indexed, _ = colors(KINDS[kind], interpolation, is_indexed=True)
    assert findings == set()
    np.testing.assert_allclose(plain[:, :3], plain[:, 3:].repeat(3, axis=1), atol=2e-3)
    np.testing.assert_allclose(np.sort(indexed, axis=0), np.sort(plain, axis=0), atol=1e-6)
    size = KINDS[kind](new_stage())[interpolation]
    values = plain[:, 3]
    assert values.min() >= 0.2 - 1e-5
    assert values.max() <= 0.8 + 1e-5
    if size == 1:
        np.testing.assert_allclose(values, 0.5, atol=1e-6)
    elif interpolation == "uniform":
        np.testing.assert_allclose(np.unique(np.round(values, 5)), np.linspace(0.2, 0.8, size), atol=1e-4)
    else:
        reach = 0.1 if interpolation == "vertex" else 1e-4  # splines that pass by their outer points
        assert values.min() <= 0.2 + reach
        assert values.max() >= 0.8 - reach
