"""A point on a subject that is skinned, blended, animated and instanced stays on its spot of the surface over 96 frames.

The subject is a sheet that bends about its middle by a skeleton, bulges by a blend shape, and stands on the stage in four ways,
all of them moving. Where the spot is, is written down here in closed form, from the motion that the stage is made of.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from pxr import Gf, Sdf, Usd, UsdGeom, UsdSkel, Vt

from render.frame import FrameRenderer
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.shot.focus.visibility import visible_shares
from render.stage import AnchorReader, StageReader, default_camera, open_stage
from tests.render.kits.stages import ASSETS, add_mesh, needs_assets, new_stage
from usd_schemas import FocusPoint

FRAMES = np.arange(1.0, 97.0)
N = 12  # cells along the sheet, which is 2 units long and 1 high
WIDTH_PX, HEIGHT_PX = 1920, 1080
FACE, FAN, WEIGHTS = 31, 1, (0.2, 0.3, 0.5)


def bend(frame: float) -> float:
    """Angle of the sheet's second half, radians."""
    return float(np.sin(frame / 9))


def bulge(frame: float) -> float:
    """Weight of the blend shape."""
    return float(0.5 - 0.5 * np.cos(frame / 7))


def turned(axis: int, angle: float) -> DoubleArray:
    """``(3, 3)`` rotation about an axis of the coordinates."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.eye(3)
    a, b = (axis + 1) % 3, (axis + 2) % 3
    matrix[[a, b], [a, b]] = c
    matrix[a, b], matrix[b, a] = -s, s
    return matrix


def placed(rotation: DoubleArray, move: object) -> DoubleArray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, move
    return matrix


def at_rest() -> tuple[DoubleArray, DoubleArray, DoubleArray]:
    """Points of the sheet, the second joint's weight at each, and the blend shape's offsets."""
    x, y = np.meshgrid(np.linspace(0, 2, N + 1), np.linspace(0, 1, 4))
    points = np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)
    weight = np.clip(points[:, 0] - 0.5, 0, 1)
    offsets = np.stack([0 * weight, 0.1 * points[:, 0], 0.4 * np.sin(np.pi * points[:, 1])], axis=1)
    return points, weight, offsets


def spot_in_sheet(frame: float) -> DoubleArray:
    """Where the spot is in the sheet's own space: blended, then skinned linearly, each corner of its triangle for itself."""
    points, weight, offsets = at_rest()
    blended = points + bulge(frame) * offsets
    joint = np.array([1.0, 0, 0])
    skinned = blended + weight[:, None] * ((blended - joint) @ turned(2, bend(frame)).T + joint - blended)
    row, column = divmod(FACE, N)
    first = row * (N + 1) + column
    quad = [first, first + 1, first + N + 2, first + N + 1]
    return np.asarray(WEIGHTS) @ skinned[[quad[0], quad[FAN + 1], quad[FAN + 2]]]


def define_subject(stage: Usd.Stage, path: str) -> None:
    """A SkelRoot with the sheet in it; the samples are the closed form's at each whole frame."""
    UsdSkel.Root.Define(stage, path)
    skeleton = UsdSkel.Skeleton.Define(stage, f"{path}/skeleton")
    joints = ["root", "root/tip"]
    rest = [Gf.Matrix4d(1), Gf.Matrix4d(1).SetTranslate(Gf.Vec3d(1, 0, 0))]
    skeleton.CreateJointsAttr(joints)
    skeleton.CreateBindTransformsAttr(rest)
    skeleton.CreateRestTransformsAttr(rest)
    motion = UsdSkel.Animation.Define(stage, f"{path}/motion")
    motion.CreateJointsAttr(joints)
    motion.CreateTranslationsAttr([Gf.Vec3f(0, 0, 0), Gf.Vec3f(1, 0, 0)])
    motion.CreateScalesAttr([Gf.Vec3h(1, 1, 1)] * 2)
    motion.CreateBlendShapesAttr(["bulge"])
    rotations, weights = motion.CreateRotationsAttr(), motion.CreateBlendShapeWeightsAttr()
    for frame in FRAMES:
        half = bend(frame) / 2
        tip = Gf.Quatf(float(np.cos(half)), 0, 0, float(np.sin(half)))
        rotations.Set(Vt.QuatfArray([Gf.Quatf(1, 0, 0, 0), tip]), frame)
        weights.Set([bulge(frame)], frame)
    UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets([motion.GetPath()])
    points, weight, offsets = at_rest()
    row, column = np.divmod(np.arange(3 * N), N)
    first = row * (N + 1) + column
    corners = np.stack([first, first + 1, first + N + 2, first + N + 1], axis=1).ravel()
    sheet = add_mesh(stage, f"{path}/sheet", points, [4] * 3 * N, corners)
    sheet.CreateDoubleSidedAttr(True)
    binding = UsdSkel.BindingAPI.Apply(sheet.GetPrim())
    binding.CreateSkeletonRel().SetTargets([skeleton.GetPath()])
    binding.CreateJointIndicesPrimvar(False, 2).Set([0, 1] * len(points))
    binding.CreateJointWeightsPrimvar(False, 2).Set(np.stack([1 - weight, weight], axis=1).ravel().tolist())
    shape = UsdSkel.BlendShape.Define(stage, f"{path}/sheet/bulge")
    shape.CreateOffsetsAttr(Vt.Vec3fArray.FromNumpy(offsets.astype(np.float32)))
    binding.CreateBlendShapesAttr(["bulge"])
    binding.CreateBlendShapeTargetsRel().SetTargets([shape.GetPath()])


Place = Callable[[float], DoubleArray]


def walk(frame: float) -> DoubleArray:
    """Return the pose of the subject's carrier at a frame."""
    return placed(turned(1, 0.02 * frame), [0.03 * frame, 0.1 * np.sin(frame / 5), -0.02 * frame])


def beside(number: int) -> DoubleArray:
    return placed(np.eye(3), [1.5 * number, -0.5 * number, -2.0 * number])


def gf(matrix: DoubleArray) -> Gf.Matrix4d:
    return Gf.Matrix4d(*matrix.T.ravel().tolist())


def animate(prim: UsdGeom.Xformable, place: Place) -> None:
    op = prim.AddTransformOp()
    for frame in FRAMES:
        op.Set(gf(place(frame)), frame)


def alone(stage: Usd.Stage) -> tuple[tuple[str, ...], int, Place]:
    """The subject itself, on a thing that walks."""
    animate(UsdGeom.Xform.Define(stage, "/walker"), walk)
    define_subject(stage, "/walker/subject")
    return ("/walker/subject/sheet",), -1, walk


def native(stage: Usd.Stage) -> tuple[tuple[str, ...], int, Place]:
    """The second of two native instances, each walking its own way."""
    stage.CreateClassPrim("/_asset")
    define_subject(stage, "/_asset/subject")
    for number in range(2):
        copy = UsdGeom.Xform.Define(stage, f"/copy{number}")
        copy.GetPrim().GetReferences().AddInternalReference("/_asset")
        copy.GetPrim().SetInstanceable(True)
        animate(copy, lambda frame, number=number: beside(number) @ walk(frame / (1 + number)))
    return ("/copy1/subject/sheet",), -1, lambda frame: beside(1) @ walk(frame / 2)


def instance_place(frame: float, number: int) -> tuple[NDArray[np.float32], float, float]:
    """Position, angle about Y and size of one instance of a PointInstancer."""
    return (
        np.array([1.2 * number - 0.01 * frame, 0.2 * np.sin(frame / 6 + number), -number], np.float32),
        0.015 * frame * (1 + number),
        0.7 + 0.2 * number,
    )


def instance_matrix(frame: float, number: int) -> DoubleArray:
    position, angle, size = instance_place(frame, number)
    return placed(turned(1, angle) * size, position)


def author_instances(stage: Usd.Stage, path: str, prototype: str, *, mixed: bool = False) -> None:
    """Three instances, of which the first is hidden now and then; ``mixed``: their order changes, and their ids go with them."""
    dots = UsdGeom.PointInstancer.Define(stage, path)
    dots.CreatePrototypesRel().SetTargets([Sdf.Path(prototype)])
    dots.CreateProtoIndicesAttr([0, 0, 0])
    for frame in FRAMES:
        order = np.roll([0, 1, 2], int(frame) // 5 if mixed else 0).tolist()
        dots.CreateIdsAttr().Set([50 + 10 * number for number in order], frame)
        places = [instance_place(frame, number) for number in order]
        dots.CreatePositionsAttr().Set([Gf.Vec3f(*p.tolist()) for p, _, _ in places], frame)
        quats = [Gf.Quatf(float(np.cos(a / 2)), 0, float(np.sin(a / 2)), 0) for _, a, _ in places]
        dots.CreateOrientationsfAttr().Set(Vt.QuatfArray(quats), frame)
        dots.CreateScalesAttr().Set([Gf.Vec3f(size) for *_, size in places], frame)
        dots.CreateInvisibleIdsAttr().Set([50] if frame % 8 < 4 else [], frame)


def points(stage: Usd.Stage) -> tuple[tuple[str, ...], int, Place]:
    """One instance of a PointInstancer, by its id."""
    define_subject(stage, "/dots/subject")
    author_instances(stage, "/dots", "/dots/subject", mixed=True)
    return ("/dots", "/dots/subject/sheet"), 70, lambda frame: instance_matrix(frame, 2)


def nested(stage: Usd.Stage) -> tuple[tuple[str, ...], int, Place]:
    """Instance 1 of an instancer that is instance 2 of another one, which walks."""
    animate(UsdGeom.Xform.Define(stage, "/walker"), walk)
    define_subject(stage, "/walker/outer/inner/subject")
    author_instances(stage, "/walker/outer/inner", "/walker/outer/inner/subject")
    author_instances(stage, "/walker/outer", "/walker/outer/inner")

    def place(frame: float) -> DoubleArray:
        return walk(frame) @ instance_matrix(frame, 2) @ instance_matrix(frame, 1)

    return ("/walker/outer", "/walker/outer/inner/subject/sheet"), 2 * 3 + 1, place


WAYS = {"alone": alone, "native": native, "points": points, "nested": nested}


def camera_at(frame: float) -> Camera:
    """A camera that dollies and pans."""
    pose = placed(turned(1, 0.05 * np.sin(frame / 11)), [0.5 + 0.01 * frame, 0.4, 9 - 0.02 * frame])
    return Camera(pose, focal_length_mm=35, horizontal_aperture_mm=36, vertical_aperture_mm=20.25)


def pixel(camera: Camera, position_m: DoubleArray) -> DoubleArray:
    """Where a pinhole camera shows a place."""
    pose = camera.world_from_camera
    x, y, z = pose[:3, :3].T @ (position_m - pose[:3, 3])
    per_mm = WIDTH_PX / camera.horizontal_aperture_mm
    return np.array([WIDTH_PX / 2, HEIGHT_PX / 2]) + camera.focal_length_mm * per_mm * np.array([x, -y]) / -z


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("metres_per_unit", "up"), [(1.0, "Y"), (0.01, "Z")])
def test_the_point_stays_on_its_spot_within_half_a_pixel(way: str, metres_per_unit: float, up: str) -> None:
    stage = new_stage(metres_per_unit, up)
    target, instance, place = WAYS[way](stage)
    point = FocusPoint("p", target, face=FACE, fan_triangle=FAN, barycentric=WEIGHTS, instance=instance)
    found = AnchorReader(stage).positions([point], FRAMES.tolist())[:, 0]
    world = np.diag([metres_per_unit] * 3) @ (turned(0, -np.pi / 2) if up == "Z" else np.eye(3))
    spots = np.array([(place(f) @ np.append(spot_in_sheet(f), 1))[:3] for f in FRAMES]) @ world.T
    assert np.ptp(spots, axis=0).min() > 0.1 * metres_per_unit
    # the camera, moved with the stage and made as small
    views = [camera_at(frame) for frame in FRAMES]
    back = found @ world / metres_per_unit**2, spots @ world / metres_per_unit**2
    away_px = [np.linalg.norm(pixel(v, a) - pixel(v, b)) for v, a, b in zip(views, *back, strict=True)]
    assert max(away_px) < 0.5
    assert max(away_px) < 0.01  # single precision does better than asked


@pytest.mark.gl
@pytest.mark.parametrize("way", WAYS)
def test_the_picture_shows_that_spot_where_the_point_is(way: str, renderer: FrameRenderer) -> None:
    """Unless something stands before it, a click on the pixel where the point lands hits its triangle within half a pixel."""
    stage = new_stage()
    target, instance, _ = WAYS[way](stage)
    point = FocusPoint("p", target, face=FACE, fan_triangle=FAN, barycentric=WEIGHTS, instance=instance)
    reader, anchors = StageReader(stage), AnchorReader(stage)
    clicked = []
    for frame in FRAMES[::9]:
        scene, camera = reader.read(frame), camera_at(frame)
        position_m = anchors.position(point, frame)
        x, y = pixel(camera, position_m)
        pick = renderer.pick(scene, camera, WIDTH_PX, HEIGHT_PX, float(x), float(y))
        assert pick is not None
        found = (pick.prim_path,) if pick.prototype_path is None else (pick.prim_path, pick.prototype_path)
        clicked.append((found, pick.instance, pick.face, pick.fan_triangle) == (target, instance, FACE, FAN))
        assert clicked[-1] == visible_shares(scene, camera, position_m[None])[0]
        if clicked[-1]:
            assert np.linalg.norm(pixel(camera, np.asarray(pick.position_m)) - [x, y]) < 0.5
    assert sum(clicked) >= 4


@needs_assets
def test_on_a_skinned_asset_points_stay_on_what_is_drawn() -> None:
    """Elephant With Monochord (ASWF's UsdSkel sample): the renderer's own triangles, skinned as a whole, over 96 frames."""
    stage = open_stage(ASSETS / "ElephantWithMonochord" / "SoC-ElephantWithMonochord.usdc")
    start = stage.GetStartTimeCode()
    times = [start + n for n in range(96)]
    reader = StageReader(stage, max_texture=16)
    camera = default_camera(stage, aspect=WIDTH_PX / HEIGHT_PX).framing
    assert camera is not None
    chosen = [
        (b, t) for b, batch in enumerate(reader.read(start).batches) for t in spread(len(batch.geometry.triangles))
    ]
    scene = reader.read(start)
    asked = []
    for b, t in chosen:
        geometry = scene.batches[b].geometry
        owner = geometry.prim_ids if scene.batches[b].instance_prim_ids is None else scene.batches[b].instance_prim_ids
        path = scene.prim_paths[owner[t] if scene.batches[b].instance_prim_ids is None else owner[0]]
        face, fan = int(geometry.face_ids[t]), int(geometry.fan_ids[t])
        asked.append(FocusPoint(f"p{len(asked)}", (path,), face=face, fan_triangle=fan, barycentric=WEIGHTS))
    found = AnchorReader(stage).positions(asked, times)
    worst_px = moved_px = 0.0
    for row, time in zip(found, times, strict=True):
        batches = reader.read(time).batches
        for (b, t), position_m, first in zip(chosen, row, found[0], strict=True):
            geometry, pose = batches[b].geometry, batches[b].poses[0]
            corners = geometry.triangles[t]
            if geometry.swapped is not None and geometry.swapped[t]:
                corners = corners[[0, 2, 1]]
            drawn = pose[:3, :3] @ (np.asarray(WEIGHTS) @ geometry.positions[corners].astype(np.float64)) + pose[:3, 3]
            worst_px = max(worst_px, float(np.linalg.norm(pixel(camera, position_m) - pixel(camera, drawn))))
            moved_px = max(moved_px, float(np.linalg.norm(pixel(camera, position_m) - pixel(camera, first))))
    assert worst_px < 0.5
    assert moved_px > 20


def spread(count: int) -> range:
    """A few of so many triangles."""
    return range(0, count, 1 + count // 6)
