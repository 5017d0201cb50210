"""A mesh that a skeleton bends."""

from __future__ import annotations

from pxr import Gf, Sdf, Usd, UsdSkel, Vt

from tests.render.kits.stages import add_mesh, new_stage, set_primvar

# A strip along +X: its left half hangs on joint 0, its right half on joint 1 at x = 1.
STRIP = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 0, -1), (1, 0, -1), (2, 0, -1)]

CORNERS = [0, 1, 4, 3, 1, 2, 5, 4]


def bent_strip(normals: str = "") -> Usd.Stage:
    """Make a strip whose right half turns up by 90 degrees about its middle, from time 0 to time 10."""
    stage = new_stage()
    root = UsdSkel.Root.Define(stage, "/rig")
    root.AddTranslateOp().Set(Gf.Vec3d(0, 0, 50))
    skeleton = UsdSkel.Skeleton.Define(stage, "/rig/skeleton")
    joints = ["root", "root/tip"]
    rest = [Gf.Matrix4d(1), Gf.Matrix4d(1).SetTranslate(Gf.Vec3d(1, 0, 0))]
    skeleton.CreateJointsAttr(joints)
    skeleton.CreateBindTransformsAttr(rest)
    skeleton.CreateRestTransformsAttr(rest)
    animation = UsdSkel.Animation.Define(stage, "/rig/animation")
    animation.CreateJointsAttr(joints)
    still = Gf.Quatf(1, 0, 0, 0)
    turned = Gf.Quatf(Gf.Rotation(Gf.Vec3d(0, 0, 1), 90).GetQuat())
    animation.CreateTranslationsAttr([Gf.Vec3f(0, 0, 0), Gf.Vec3f(1, 0, 0)])
    animation.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * 2)
    animation.CreateRotationsAttr().Set(Vt.QuatfArray([still, still]), 0)
    animation.GetRotationsAttr().Set(Vt.QuatfArray([still, turned]), 10)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([animation.GetPath()])
    mesh = add_mesh(stage, "/rig/strip", STRIP, [4, 4], CORNERS)
    binding = UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 1).Set([0, 0, 1, 0, 0, 1])
    binding.CreateJointWeightsPrimvar(False, 1).Set([1.0] * 6)
    if normals:
        count = {"vertex": 6, "faceVarying": 8}[normals]
        set_primvar(mesh.GetPrim(), "normals", Sdf.ValueTypeNames.Normal3fArray, normals, [Gf.Vec3f(0, 1, 0)] * count)
    return stage
