"""Which sides of surfaces are drawn: both, but for back faces that closed surfaces hide."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux, Vt

from render.frame import FrameRenderer
from render.gl.shaders import ProgramCache
from render.layers.peel import Peeler
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Scene
from render.optics.view import PinholeView
from render.stage import StageReader
from tests.render.kits.stages import add_material, add_mesh, bind, new_stage, only_batch, read

pytestmark = pytest.mark.gl

SIZE = (64, 48)
BOX_POINTS = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
BOX_FACES = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]


@pytest.fixture
def peeler(renderer: FrameRenderer) -> Iterator[Peeler]:
    made = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def looking(x: float = 0.0, y: float = 0.0, z: float = 0.0, *, back: bool = False, near_m: float = 0.1) -> Camera:
    """A camera that looks along -Z, or with ``back`` along +Z."""
    pose = np.diag([-1.0, 1, -1, 1]) if back else np.eye(4)
    pose[:3, 3] = x, y, z
    return Camera(pose, 20, 36, 27, near_m=near_m)


def coverage(renderer: FrameRenderer, scene: Scene, camera: Camera) -> float:
    """Share of the picture that is covered."""
    settings = FrameSettings(*SIZE, engine="pinhole", rays=1, supersample=1)
    return float(renderer.render(scene, camera, settings).color[..., 3].mean())


def peeled(peeler: Peeler, scene: Scene, camera: Camera) -> int:
    """Number of layers of a scene, all that lies behind one pixel."""
    peeler.load(scene)
    return peeler.peel(PinholeView.from_camera(camera, *SIZE), layers=8, umbra=1e-4, unlit=True).count


def ball(opacity: float = 1.0) -> Usd.Stage:
    """A stage with a sphere of radius 1 about the origin."""
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/ball")
    add_material(stage, "/look", opacity=opacity)
    bind(stage.GetPrimAtPath("/ball"), "/look")
    return stage


def test_both_sides_of_an_open_surface_are_drawn_by_default(renderer: FrameRenderer) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    behind = looking(0.5, 0.5, -2, back=True)
    assert coverage(renderer, read(stage), behind) > 0.05
    assert coverage(renderer, read(stage, cull_backfaces=True), behind) == 0
    mesh.CreateDoubleSidedAttr(True)
    assert coverage(renderer, read(stage, cull_backfaces=True), behind) > 0.05


def test_a_closed_surface_has_one_layer_from_outside(peeler: Peeler) -> None:
    scene = read(ball())
    batch = only_batch(scene)
    assert batch.has_backs
    np.testing.assert_allclose(batch.insides, [[[-1, -1, -1], [1, 1, 1]]], atol=1e-6)
    assert peeled(peeler, scene, looking(z=4)) == 1
    open_ = replace(scene, batches=(replace(batch, insides=None),))
    assert peeled(peeler, open_, looking(z=4)) == 2


def test_the_inside_of_a_closed_surface_is_drawn_from_within(renderer: FrameRenderer) -> None:
    scene = read(ball())
    assert coverage(renderer, scene, looking()) == 1
    assert coverage(renderer, read(ball(), cull_backfaces=True), looking()) == 0


def test_the_near_plane_cuts_a_closed_surface_open(renderer: FrameRenderer) -> None:
    """A ball of which only the farther half is in front of the near plane shows its inside."""
    assert coverage(renderer, read(ball()), looking(z=2, near_m=2.0)) > 0.2
    assert coverage(renderer, read(ball(), cull_backfaces=True), looking(z=2, near_m=2.0)) == 0


def test_back_faces_of_what_is_clear_are_seen_through_it(peeler: Peeler) -> None:
    assert peeled(peeler, read(ball(0.5)), looking(z=4)) == 2


def test_a_back_face_is_lit_as_its_front_unless_double_sided(renderer: FrameRenderer) -> None:
    """The back of a double-sided square is lit from the eye's side, that of another from beyond it, as in Storm."""
    stage = new_stage()
    mesh = add_mesh(stage, "/m")
    sun = UsdLux.DistantLight.Define(stage, "/sun")
    sun.CreateIntensityAttr(1e6)
    turn = UsdGeom.Xformable(sun).AddRotateYOp()

    def brightness(from_behind: bool) -> float:
        turn.Set(180.0 if from_behind else 0.0)  # a distant light shines along its own -Z
        settings = FrameSettings(*SIZE, engine="pinhole", rays=1, supersample=1)
        return float(renderer.render(read(stage), looking(0.5, 0.5, -2, back=True), settings).color[24, 32, 0])

    assert brightness(from_behind=True) == 0
    assert brightness(from_behind=False) > 0.05
    mesh.CreateDoubleSidedAttr(True)
    assert brightness(from_behind=True) > 0.05
    assert brightness(from_behind=False) == 0


def test_a_surface_that_faces_inwards_is_seen_from_outside(renderer: FrameRenderer) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/box", BOX_POINTS, [4] * 6, BOX_FACES)
    for mirror in (1, -1):
        UsdGeom.XformCommonAPI(mesh).SetScale(Gf.Vec3f(mirror, 1, 1))
        for orientation, is_outward in (("rightHanded", True), ("leftHanded", False)):
            mesh.CreateOrientationAttr(orientation)
            scene = read(stage)
            settings = FrameSettings(*SIZE, engine="pinhole", rays=1, supersample=1, aovs=("color", "depth"))
            assert renderer.render(scene, looking(z=4), settings).aovs["depth"][24, 32] == pytest.approx(3)
            assert (only_batch(scene).insides is not None) == is_outward


def test_instances_have_their_insides_where_they_stand(renderer: FrameRenderer, peeler: Peeler) -> None:
    stage = new_stage()
    dots = UsdGeom.PointInstancer.Define(stage, "/dots")
    UsdGeom.Sphere.Define(stage, "/dots/ball")
    dots.CreatePrototypesRel().SetTargets(["/dots/ball"])
    dots.CreateProtoIndicesAttr([0, 0])
    dots.CreatePositionsAttr([(-5, 0, 0), (5, 0, 0)])
    scene = read(stage)
    for x in (-5, 5):
        assert coverage(renderer, scene, looking(x)) == 1
        assert peeled(peeler, scene, looking(x, z=4)) == 1


@pytest.mark.parametrize(("opacity", "layers"), [(1.0, 1), (0.3, 2)])
def test_the_inside_of_other_parts_is_seen_through_glass(peeler: Peeler, opacity: float, layers: int) -> None:
    """A box whose front is a part of its own: where that is clear, the inner side of its back is seen."""
    stage = new_stage()
    mesh = add_mesh(stage, "/box", BOX_POINTS, [4] * 6, BOX_FACES)
    for name, faces_of, clear in (("front", [1], opacity), ("others", [0, 2, 3, 4, 5], 1.0)):
        add_material(stage, f"/{name}", opacity=clear, roughness=0.2 if name == "front" else 0.7)
        subset = UsdGeom.Subset.CreateGeomSubset(mesh, name, UsdGeom.Tokens.face, faces_of, "materialBind")
        bind(subset.GetPrim(), f"/{name}")
    assert peeled(peeler, read(stage), looking(z=4)) == layers


def test_boxes_that_come_apart_show_their_insides(renderer: FrameRenderer) -> None:
    """Six squares that touch at first and leave each other later, whichever time is read first."""
    stage = new_stage()
    mesh = add_mesh(stage, "/box", BOX_POINTS[BOX_FACES], [4] * 6, range(24))
    apart = BOX_POINTS[BOX_FACES].copy()
    apart[4:8] += (0, 5, 0)  # the front
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(BOX_POINTS[BOX_FACES]), 1)
    mesh.GetPointsAttr().Set(Vt.Vec3fArray.FromNumpy(apart), 24)
    reader = StageReader(stage)
    reader.read(1)
    for scene in (reader.read(24), read(stage, 24)):
        assert coverage(renderer, scene, looking(z=4)) > 0.05


def test_a_part_by_material_knows_the_whole_surface(renderer: FrameRenderer) -> None:
    """From within a box whose sides wear several materials each side is drawn: the eye is outside of a side's own box."""
    stage = new_stage()
    mesh = add_mesh(stage, "/box", BOX_POINTS, [4] * 6, BOX_FACES)
    for i in range(6):
        add_material(stage, f"/look{i}", roughness=0.2 + 0.1 * i)
        subset = UsdGeom.Subset.CreateGeomSubset(mesh, f"side{i}", UsdGeom.Tokens.face, [i], "materialBind")
        bind(subset.GetPrim(), f"/look{i}")
    scene = read(stage)
    assert len(scene.batches) == 6
    assert coverage(renderer, scene, looking()) == 1
    assert coverage(renderer, scene, looking(back=True)) == 1
