"""The demo shot: what issue 2 asks of it, and what a picture of it must show."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils, UsdValidation

from render.demo.camera import CAMERA
from render.demo.performance import MARA, PIP
from render.demo.shot import write_demo
from render.errors import OutputError
from render.frame import FrameRenderer, FrameSettings
from render.shot import Shot
from usd_schemas.view import LensCamera


@pytest.fixture(scope="module")
def path(demo_file: Path) -> Path:
    return demo_file


@pytest.fixture(scope="module")
def shot(path: Path) -> Shot:
    return Shot.open(path)


def digests(directory: Path) -> dict[str, str]:
    files = sorted(file for file in directory.rglob("*") if file.is_file())
    return {str(file.relative_to(directory)): hashlib.sha256(file.read_bytes()).hexdigest() for file in files}


def meshes(stage: Usd.Stage) -> Iterator[UsdGeom.Mesh]:
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), Usd.TraverseInstanceProxies()):
        if prim.IsA(UsdGeom.Mesh):
            yield UsdGeom.Mesh(prim)


def emitted(prim: Usd.Prim) -> float:
    """The brightest channel of the constant emission of a prim's material."""
    material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    surface = material.ComputeSurfaceSource()[0]
    value = surface.GetInput("emissiveColor").Get()
    return max(value) if value else 0.0


def test_two_writings_are_the_same_bytes(path: Path, tmp_path: Path) -> None:
    again = write_demo(tmp_path / "new" / "folder")
    assert again == tmp_path / "new" / "folder" / path.name
    assert digests(again.parent) == digests(path.parent)


def test_writing_over_an_older_copy_gives_the_same_files(tmp_path: Path, path: Path) -> None:
    (tmp_path / path.name).write_text("#usda 1.0\nbroken")
    (tmp_path / "set.usdc").write_bytes(b"broken")
    write_demo(tmp_path)
    assert digests(tmp_path) == digests(path.parent)


def test_a_file_in_the_way_is_an_output_error(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("")
    with pytest.raises(OutputError, match="taken"):
        write_demo(tmp_path / "taken")


def test_it_needs_nothing_from_outside_its_folder(path: Path) -> None:
    layers, assets, unresolved = UsdUtils.ComputeAllDependencies(Sdf.AssetPath(str(path)))
    assert not unresolved
    files = [Path(layer.realPath) for layer in layers] + [Path(asset) for asset in assets]
    assert len(files) > 15
    assert all(file.is_relative_to(path.parent) for file in files)
    authored: list[str] = []
    for layer in layers:
        UsdUtils.ModifyAssetPaths(layer, lambda asset: authored.append(asset) or asset)
    assert authored
    assert all(asset.startswith("./") for asset in authored)
    assert sum(file.stat().st_size for file in set(files)) < 12e6


def test_validators_find_nothing(shot: Shot) -> None:
    registry = UsdValidation.ValidationRegistry()
    errors = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators()).Validate(shot.stage)
    assert [(error.GetName(), error.GetMessage()) for error in errors] == []


def test_the_reader_honours_all_of_it(shot: Shot) -> None:
    scene = shot.scene_at(1)
    assert 150_000 <= scene.triangle_count <= 500_000
    assert len(scene.batches) <= 100
    assert shot.findings() == []


def test_it_is_96_frames_at_24_with_a_named_moving_camera(shot: Shot) -> None:
    assert (shot.frame_range.start, shot.frame_range.end, shot.frame_range.frames_per_second) == (1, 96, 24)
    assert shot.default_camera().path == CAMERA
    first, last = (shot.camera_at(CAMERA, frame, 960, 540) for frame in (1, 96))
    assert 0.2 < np.linalg.norm((last.world_from_camera - first.world_from_camera)[:3, 3]) < 1.0
    assert 1.39 <= first.f_stop <= 2
    assert 35 <= first.focal_length_mm <= 50
    assert first.exposure_scale == 1


def test_at_least_sixty_small_bright_lights_hang_behind_the_subjects(shot: Shot) -> None:
    stage, bright = shot.stage, []
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.PointInstancer):
            continue
        instancer = UsdGeom.PointInstancer(prim)
        shining = [
            any(emitted(part) >= 20 for part in Usd.PrimRange(stage.GetPrimAtPath(target)) if part.IsA(UsdGeom.Mesh))
            for target in instancer.GetPrototypesRel().GetTargets()
        ]
        places = instancer.ComputeInstanceTransformsAtTime(1, 1)
        world = UsdGeom.XformCache(1).GetLocalToWorldTransform(prim)
        indices = instancer.GetProtoIndicesAttr().Get()
        bright += [(place * world).ExtractTranslation() for place, i in zip(places, indices, strict=True) if shining[i]]
    behind = [place for place in bright if place[2] < -650]
    assert len(behind) >= 60


def test_lights_are_few_and_of_many_kinds(shot: Shot) -> None:
    lights = [prim for prim in shot.stage.Traverse() if prim.HasAPI(UsdLux.LightAPI)]
    assert len(lights) <= 18
    kinds = {prim.GetTypeName() for prim in lights}
    assert kinds == {"DomeLight", "DistantLight", "SphereLight", "RectLight", "DiskLight"}


def test_instances_are_native_and_points(shot: Shot) -> None:
    prims = list(shot.stage.Traverse())
    assert sum(prim.IsInstance() for prim in prims) > 40
    assert sum(prim.IsA(UsdGeom.PointInstancer) for prim in prims) >= 3


def test_the_near_and_the_far_subject_move_at_their_depths(shot: Shot) -> None:
    tracks = {name: [] for name in ("pip", "mara")}
    for frame in (1, 24, 48, 72, 96):
        for placed in shot.focus.points(CAMERA, frame):
            assert placed.visible_in_frame
            tracks[placed.point.name].append((placed.depth_m, *placed.position_m))
    pip, mara = (np.array(tracks[name]) for name in ("pip", "mara"))
    assert ((pip[:, 0] > 2.2) & (pip[:, 0] < 3.0)).all()
    assert ((mara[:, 0] > 7.0) & (mara[:, 0] < 10.0)).all()
    for track in (pip, mara):
        assert np.linalg.norm(np.diff(track[:, 1:], axis=0), axis=1).max() > 0.03


def test_foreground_leaves_move_out_of_the_picture(shot: Shot) -> None:
    """Leaves well in front of the near subject, fewer of them in the picture at the end."""
    leaves = UsdGeom.PointInstancer(shot.stage.GetPrimAtPath("/World/Set/Foreground/Leaves"))
    places = np.array(leaves.GetPositionsAttr().Get(), float) / 100
    seen = []
    for frame in (1, 96):
        camera = shot.camera_at(CAMERA, frame, 960, 540)
        view = np.c_[places, np.ones(len(places))] @ np.linalg.inv(camera.world_from_camera).T
        depth = -view[:, 2]
        half = camera.horizontal_aperture_mm / camera.focal_length_mm / 2
        inside = (np.abs(view[:, 0]) < half * depth) & (np.abs(view[:, 1]) < half * 9 / 16 * depth)
        near = min(placed.depth_m for placed in shot.focus.points(CAMERA, frame))
        assert (depth[inside] < 0.6 * near).all()
        seen.append(int(inside.sum()))
    assert seen[0] > max(seen[1], 5)


def test_the_focus_racks_from_the_near_face_to_the_far_one(shot: Shot) -> None:
    points = {point.name: point for point in LensCamera(shot.stage.GetPrimAtPath(CAMERA)).focus_points()}
    assert points["pip"].read(1).target[0].startswith(PIP)
    assert points["mara"].read(1).target[0].startswith(MARA)
    assert [round(points["pip"].read(frame).weight, 6) for frame in (1, 44, 55, 66, 96)] == [1, 1, 0.5, 0, 0]
    distances = [shot.camera_at(CAMERA, frame, 960, 540).focus_distance_m for frame in range(44, 67)]
    depths = {placed.point.name: placed.depth_m for placed in shot.focus.points(CAMERA, 66)}
    assert distances[0] < 3
    assert distances[-1] == pytest.approx(depths["mara"], rel=1e-6)
    assert (np.diff(distances) > -0.01).all()


@pytest.mark.gl
def test_the_rack_is_seen(shot: Shot, renderer: FrameRenderer) -> None:
    """The far face gets sharper and the near one softer; measured by the steepest edges of each face's surroundings."""
    sharpness = {}
    for frame in (36, 72):
        scene = shot.scene_at(frame)
        camera = shot.camera_at(CAMERA, frame, 480, 270)
        radiance = renderer.render(scene, camera, FrameSettings(width=480, height=270, rays=24, supersample=1)).color
        seen = np.sqrt(np.clip(radiance[..., :3].mean(axis=2), 0, 1))
        slope = np.hypot(*np.gradient(seen))
        for placed in shot.focus.points(CAMERA, frame):
            x, y = int(placed.screen[0] * 480), int(placed.screen[1] * 270)
            reach = 40 if placed.point.name == "pip" else 16
            window = slope[max(y - reach, 0) : y + reach, max(x - reach, 0) : x + reach]
            sharpness[placed.point.name, frame] = np.percentile(window, 98)
    assert sharpness["pip", 36] > 1.5 * sharpness["pip", 72]
    assert sharpness["mara", 72] > 1.5 * sharpness["mara", 36]
