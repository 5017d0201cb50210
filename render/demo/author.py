"""Writes kit meshes and motions into USD. The one place of the demo that knows scene units (centimetres).

The shot is made of layers by department, as productions do it; `Department` names them. Each prim is authored into the
layer of its department by making that layer the stage's edit target.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, Vt

from render.demo.shapes.mesh import Array, Mesh

UNITS_PER_METRE = 100.0
FIRST_FRAME, LAST_FRAME, FRAMES_PER_SECOND = 1, 96, 24
LOOKS = "/World/Looks"

Motion = Callable[[float], ArrayLike]


def frames() -> range:
    """The shot's frames, both ends included."""
    return range(FIRST_FRAME, LAST_FRAME + 1)


@contextmanager
def editing(stage: Usd.Stage, layer: Sdf.Layer) -> Iterator[None]:
    """Direct authoring into ``layer`` within the context."""
    with Usd.EditContext(stage, Usd.EditTarget(layer)):
        yield


def units(metres: ArrayLike) -> Array:
    """Metres as scene units."""
    return np.asarray(metres, np.float64) * UNITS_PER_METRE


def vector(metres: ArrayLike) -> Gf.Vec3d:
    """A position in metres as scene units, rounded to a thousandth of a millimetre so that text layers stay short."""
    return Gf.Vec3d(*(round(float(x), 4) for x in units(metres)))


def write_mesh(stage: Usd.Stage, path: str, mesh: Mesh, look: str, *, double_sided: bool = False) -> UsdGeom.Mesh:
    """Defines a polygon mesh with normals, ``st`` and a bound material.

    Args:
        stage: where.
        path: prim path.
        mesh: metres.
        look: name of a material under `LOOKS`.
        double_sided: whether both sides of its faces are seen (cloth, leaves).
    """
    prim = UsdGeom.Mesh.Define(stage, path)
    counts = [4] * len(mesh.quads) + [3] * len(mesh.triangles)
    corners = np.concatenate([mesh.quads.ravel(), mesh.triangles.ravel()])
    points = units(mesh.points).astype(np.float32)
    prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
    prim.CreateFaceVertexCountsAttr(Vt.IntArray(counts))
    prim.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners.astype(np.int32)))
    prim.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(mesh.normals.astype(np.float32)))
    prim.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    prim.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    prim.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([points.min(axis=0), points.max(axis=0)])))
    st = UsdGeom.PrimvarsAPI(prim).CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex)
    st.Set(Vt.Vec2fArray.FromNumpy(mesh.uvs.astype(np.float32)))
    if double_sided:
        prim.CreateDoubleSidedAttr(True)
    bind(prim.GetPrim(), look)
    return prim


def bind(prim: Usd.Prim, look: str) -> None:
    """Binds the material of that name."""
    rel = UsdShade.MaterialBindingAPI.Apply(prim).GetDirectBindingRel()
    rel.SetTargets([Sdf.Path(f"{LOOKS}/{look}")])


def write_part(stage: Usd.Stage, path: str, meshes: dict[str, Mesh], double_sided: Sequence[str] = ()) -> Usd.Prim:
    """Defines an Xform with one mesh for each look.

    Args:
        stage: where.
        path: of the Xform.
        meshes: mesh by look name; the mesh prims are called after their look.
        double_sided: looks whose mesh is seen from both sides.
    """
    prim = UsdGeom.Xform.Define(stage, path).GetPrim()
    for look, mesh in meshes.items():
        write_mesh(stage, f"{path}/{look}", mesh, look, double_sided=look in double_sided)
    return prim


def stand(prim: Usd.Prim, position: ArrayLike, *, yaw: float = 0.0, scale: float = 1.0) -> None:
    """Places a prim that does not move: metres, degrees about +Y, uniform scale."""
    common = UsdGeom.XformCommonAPI(prim)
    common.SetTranslate(vector(position))
    if yaw:
        common.SetRotate(Gf.Vec3f(0, round(yaw, 3), 0))
    if scale != 1.0:
        common.SetScale(Gf.Vec3f(round(scale, 4)))


def instance(
    stage: Usd.Stage, path: str, prop: str, position: ArrayLike, *, yaw: float = 0.0, scale: float = 1.0
) -> None:
    """Places a native instance of a prop of the library (a class prim)."""
    prim = UsdGeom.Xform.Define(stage, path).GetPrim()
    prim.GetReferences().AddInternalReference(Sdf.Path(prop))
    prim.SetInstanceable(True)
    stand(prim, position, yaw=yaw, scale=scale)


def animate(
    prim: Usd.Prim, *, translate: Motion | None = None, rotate: Motion | None = None, scale: Motion | None = None
) -> None:
    """Keys a prim at every frame.

    Args:
        prim: an Xformable.
        translate: metres at a frame.
        rotate: degrees about X, Y, Z at a frame, applied in that order.
        scale: factors at a frame.
    """
    xformable = UsdGeom.Xformable(prim)
    if translate is not None:
        op = xformable.AddTranslateOp()
        for frame in frames():
            op.Set(vector(translate(frame)), frame)
    if rotate is not None:
        op = xformable.AddRotateXYZOp()
        for frame in frames():
            op.Set(Gf.Vec3f(*(round(float(x), 3) for x in np.asarray(rotate(frame)))), frame)
    if scale is not None:
        op = xformable.AddScaleOp()
        for frame in frames():
            op.Set(Gf.Vec3f(*(round(float(x), 4) for x in np.asarray(scale(frame)))), frame)
