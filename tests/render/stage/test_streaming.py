"""Memory of stages with many instances and long animations: instances share one shape, and a frame reads its own values alone."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from render.shot import Shot
from tests.render.kits.stages import add_mesh, dense_grid, new_stage, only_batch, read

INSTANCES = 2_000
FRAMES, POINTS = 40, 60_000
"""Size of the animation: 29 MB of points."""


def instanced(count: int) -> Usd.Stage:
    stage = new_stage()
    stage.CreateClassPrim("/asset")
    dense_grid(stage, "/asset/mesh", 20)
    stage.DefinePrim("/set")
    parent = stage.GetRootLayer().GetPrimAtPath("/set")
    with Sdf.ChangeBlock():
        for number in range(count):
            prim = Sdf.PrimSpec(parent, f"i{number}", Sdf.SpecifierDef, "Xform")
            prim.SetInfo("instanceable", True)
            prim.inheritPathList.prependedItems = ["/asset"]
            place = Sdf.AttributeSpec(prim, "xformOp:translate", Sdf.ValueTypeNames.Double3)
            place.default = Gf.Vec3d(number, 0, 0)
            order = Sdf.AttributeSpec(prim, "xformOpOrder", Sdf.ValueTypeNames.TokenArray, Sdf.VariabilityUniform)
            order.default = Vt.TokenArray(["xformOp:translate"])
    return stage


def test_native_instances_keep_one_shape() -> None:
    batch = only_batch(read(instanced(INSTANCES)))
    assert len(batch.geometry.triangles) == len(only_batch(read(instanced(1))).geometry.triangles)
    assert np.array_equal(np.sort(batch.poses[:, 0, 3]), np.arange(INSTANCES))


def write_points(layer: Sdf.Layer, path: str, frames: list[int]) -> None:
    """Samples of points that move: sample t of all points is t along X."""
    for frame in frames:
        points = np.full((POINTS, 3), frame, np.float32)
        layer.SetTimeSample(path, frame, Vt.Vec3fArray.FromNumpy(points))


def animated_mesh(stage: Usd.Stage) -> None:
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    corners = np.arange(POINTS // 3 * 3)
    add_mesh(stage, "/mesh", np.zeros((POINTS, 3)), np.full(POINTS // 3, 3), corners)
    stage.SetStartTimeCode(1)
    stage.SetEndTimeCode(FRAMES)


@pytest.fixture
def clips(tmp_path: Path) -> Path:
    """An animation with a file for each frame."""
    manifest = Sdf.Layer.CreateNew(str(tmp_path / "manifest.usda"))
    over = Sdf.PrimSpec(manifest, "mesh", Sdf.SpecifierOver)
    Sdf.AttributeSpec(over, "points", Sdf.ValueTypeNames.Point3fArray)
    manifest.Save()
    for frame in range(1, FRAMES + 1):
        layer = Sdf.Layer.CreateNew(str(tmp_path / f"clip{frame}.usdc"))
        over = Sdf.PrimSpec(layer, "mesh", Sdf.SpecifierOver)
        Sdf.AttributeSpec(over, "points", Sdf.ValueTypeNames.Point3fArray)
        write_points(layer, "/mesh.points", [frame])
        layer.Save()
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usdc"))
    animated_mesh(stage)
    mesh = stage.GetPrimAtPath("/mesh")
    mesh.GetAttribute("points").Clear()
    api = Usd.ClipsAPI(mesh)
    frames = range(1, FRAMES + 1)
    api.SetClipAssetPaths([Sdf.AssetPath(f"./clip{frame}.usdc") for frame in frames])
    api.SetClipManifestAssetPath(Sdf.AssetPath("./manifest.usda"))
    api.SetClipPrimPath("/mesh")
    api.SetClipActive([Gf.Vec2d(frame, frame - 1) for frame in frames])
    api.SetClipTimes([Gf.Vec2d(frame, frame) for frame in frames])
    stage.Save()
    return tmp_path / "shot.usdc"


def opened_clips(folder: Path) -> set[str]:
    layers = {Path(layer.realPath) for layer in Sdf.Layer.GetLoadedLayers() if layer.realPath}
    return {path.stem for path in layers if path.parent == folder and path.stem.startswith("clip")}


def test_a_frame_opens_its_value_clips_alone(clips: Path) -> None:
    shot = Shot.open(clips)
    assert opened_clips(clips.parent) == set()
    assert shot.scene_at(7).batches[0].geometry.positions.max() == 7
    assert opened_clips(clips.parent) <= {"clip6", "clip7", "clip8"}
    shot.scene_at(30)
    assert len(opened_clips(clips.parent)) <= 6


@pytest.fixture
def samples(tmp_path: Path) -> Path:
    """An animation with all frames in one file."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "shot.usdc"))
    animated_mesh(stage)
    write_points(stage.GetRootLayer(), "/mesh.points", list(range(1, FRAMES + 1)))
    stage.Save()
    return tmp_path / "shot.usdc"


def test_frames_of_an_animation_do_not_pile_up(samples: Path) -> None:
    shot = Shot.open(samples)
    for frame in (1, 2):
        assert shot.scene_at(frame).batches[0].geometry.positions.max() == frame
    tracemalloc.start()
    shot.scene_at(3)
    after_one = tracemalloc.get_traced_memory()[0]
    for frame in range(4, 24):
        shot.scene_at(frame)
    grown = tracemalloc.get_traced_memory()[0] - after_one
    tracemalloc.stop()
    assert grown < 12 * POINTS  # the points of one frame


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not tell which pages are resident")
def test_a_frame_reads_its_own_samples_alone(samples: Path) -> None:
    before = mapped_bytes()
    shot = Shot.open(samples)
    shot.scene_at(20)
    assert mapped_bytes() - before < samples.stat().st_size / 4
    every = shot.stage.GetPrimAtPath("/mesh").GetAttribute("points")
    total = sum(float(np.array(every.Get(frame)).max()) for frame in range(1, FRAMES + 1))
    assert total == sum(range(1, FRAMES + 1))
    assert mapped_bytes() - before > samples.stat().st_size / 2


def mapped_bytes() -> int:
    """Resident pages of mapped files."""
    return int(Path("/proc/self/statm").read_text().split()[2]) * 4096
