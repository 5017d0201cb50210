"""Peeled layers, their ranges, ids and picks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from render.errors import SettingsError
from render.frame import FrameRenderer, FrameSettings
from render.gl.compat import GL
from render.gl.shaders import ProgramCache
from render.lab.reference.scenes import checkerboard, posts_before_wall, rectangle, sphere, spheres_over_checkerboard
from render.layers.clusters import DrawRange
from render.layers.peel import HIDES_ALL, Peeler, umbra_reach
from render.layers.peeled import Layers
from render.layers.renderer import LayerRenderer
from render.layers.source_program import SourceProgram
from render.model.camera import Camera
from render.model.scene import Batch, Dome, Material, Scene
from render.optics.view import PinholeView

SIZE = (160, 120)
DARK = Dome((0, 0, 0), np.eye(4), visible=False)


@pytest.fixture
def peeler(renderer: FrameRenderer) -> Iterator[Peeler]:
    made = Peeler(renderer.graphics, ProgramCache(renderer.graphics.ctx))
    yield made
    made.release()


def stacked(depths: list[float], opacity: float = 1.0) -> Scene:
    """Unlit walls across the whole view, one behind the other; wall i glows with radiance i + 1."""
    batches = []
    for i, depth in enumerate(depths):
        wall = rectangle((0, 0, -depth), (9 * depth, 0, 0), (0, 9 * depth, 0), prim=i)
        glow = Material(base_color=(0, 0, 0), emissive=(i + 1.0,) * 3, opacity=opacity)
        batches.append(Batch(wall, glow, np.eye(4)[None]))
    return Scene(tuple(batches), (), DARK, tuple(f"/wall{i}" for i in range(len(depths))))


def view(f_px: float = 200.0) -> PinholeView:
    camera = Camera(np.eye(4), f_px / SIZE[0] * 36, 36, 36 * SIZE[1] / SIZE[0], near_m=0.1)
    return PinholeView.from_camera(camera, *SIZE)


def depths_of(layers: Layers, count: int) -> np.ndarray:
    packs = [np.frombuffer(pack.read(), np.float32).reshape(*SIZE[::-1], 4) for pack in layers.targets.packed_w]
    return np.abs(np.concatenate(packs, axis=2)[..., :count].transpose(2, 0, 1))


def test_layers_run_near_to_far_and_skip_the_umbra_of_the_last(peeler: Peeler) -> None:
    scene, camera = posts_before_wall()
    peeler.load(scene)
    umbra = 0.05
    layers = peeler.peel(PinholeView.from_camera(camera, *SIZE), layers=4, umbra=umbra)
    assert layers.count == 4
    w = depths_of(layers, 4)
    filled = w[1:] > 0
    assert filled.any(axis=(1, 2)).all()
    assert (w[:-1][filled] - w[1:][filled] > umbra * 0.999).all()
    assert not (filled & (w[:-1] == 0)).any(), "a pixel that is empty stays empty"


def test_a_layer_is_drawn_before_its_emptiness_is_queried(peeler: Peeler, monkeypatch: pytest.MonkeyPatch) -> None:
    """Mesa 22 answers an occlusion query, and frees it, while a large scene is still drawn into it: the process crashes later.

    Only some scenes and sizes do so; that the device had finished is seen with any.
    """
    fences, finished = [], []
    end, answer = GL.glEndQuery, GL.glGetQueryObjectuiv

    def ended(target: int) -> None:
        end(target)
        fences.append(GL.glFenceSync(GL.GL_SYNC_GPU_COMMANDS_COMPLETE, 0))

    def answered(name: int, what: int) -> object:
        finished.append(GL.glClientWaitSync(fences[-1], 0, 0) == GL.GL_ALREADY_SIGNALED)
        GL.glDeleteSync(fences[-1])
        return answer(name, what)

    scene, camera = spheres_over_checkerboard()
    peeler.load(scene)
    monkeypatch.setattr(GL, "glEndQuery", ended)
    monkeypatch.setattr(GL, "glGetQueryObjectuiv", answered)
    layers = peeler.peel(PinholeView.from_camera(camera, 1280, 960), layers=8, umbra=0.01)
    assert len(fences) == layers.count + 1
    assert all(finished)


def test_what_the_pupil_cannot_see_is_not_peeled(peeler: Peeler) -> None:
    """Walls at w = 1, 0.96 and 0.5: a pupil whose umbra reaches 0.05 in w never sees the second (Lee et al., section 3.1)."""
    peeler.load(stacked([1.0, 1 / 0.96, 2.0]))
    layers = peeler.peel(view(), layers=4, umbra=0.05)
    assert layers.count == 2
    np.testing.assert_allclose(depths_of(layers, 2)[:, 60, 80], [1.0, 0.5], rtol=1e-6)


def test_a_pinhole_has_one_layer(peeler: Peeler) -> None:
    scene, camera = posts_before_wall()
    peeler.load(scene)
    assert peeler.peel(PinholeView.from_camera(camera, *SIZE), layers=4, umbra=umbra_reach(0.0)).count == 1
    assert umbra_reach(0.0) == HIDES_ALL


def test_transparent_walls_are_all_peeled_and_composited(renderer: FrameRenderer) -> None:
    """Three walls of opacity 1/2 with radiance 1, 2, 3: 0.5·1 + 0.25·2 + 0.125·3 = 1.375, coverage 7/8."""
    scene = stacked([2.0, 2.02, 2.04], opacity=0.5)
    camera = Camera(np.eye(4), 50, 36, 27, f_stop=2.0, focus_distance_m=1.0, near_m=0.1)
    for engine in ("lens", "accumulation", "pinhole"):
        frame = renderer.render(scene, camera, FrameSettings(*SIZE, engine=engine, rays=16))
        np.testing.assert_allclose(frame.color[60, 80], [1.375, 1.375, 1.375, 0.875], rtol=2e-3, err_msg=engine)


def test_a_cut_out_is_a_hole(renderer: FrameRenderer) -> None:
    scene = stacked([2.0, 3.0], opacity=0.4)
    cut = replace(scene.batches[0], material=replace(scene.batches[0].material, opacity_threshold=0.5))
    solid = replace(scene.batches[1], material=replace(scene.batches[1].material, opacity=1.0))
    frame = renderer.render(replace(scene, batches=(cut, solid)), Camera(np.eye(4)), FrameSettings(*SIZE, rays=1))
    np.testing.assert_allclose(frame.color[60, 80], [2, 2, 2, 1])


def test_a_pick_is_the_exact_point_of_the_surface(renderer: FrameRenderer) -> None:
    scene, camera = spheres_over_checkerboard()
    hits = 0
    for x, y in [(240, 200), (100, 60), (300, 150), (10, 260), (400, 30), (251.3, 140.8)]:
        pick = renderer.pick(scene, camera, 480, 270, x, y)
        if pick is None:
            continue
        hits += 1
        pixels, depth = PinholeView.from_camera(camera, 480, 270).project(np.array([pick.position_m]))
        np.testing.assert_allclose(pixels[0], [x, y], atol=1e-3)
        assert depth[0] == pytest.approx(pick.depth_m)
        assert sum(pick.barycentric) == pytest.approx(1)
        assert pick.prim_path in scene.prim_paths
    assert hits >= 4


def test_a_pick_of_an_instance_names_its_number(renderer: FrameRenderer) -> None:
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, 0, 3] = [-1.0, 0.0, 1.0]
    ball = Batch(
        sphere((0, 0, -4), 0.3, prim=1),
        Material(),
        poses,
        instance_prim_ids=np.zeros(3, np.int32),
        instance_numbers=np.array([7, 8, 9], np.int32),
    )
    scene = Scene((ball,), (), None, ("/instancer", "/prototypes/ball"))
    camera = Camera(np.eye(4), 36, 36, 27)
    pick = renderer.pick(scene, camera, 400, 300, 300, 150)
    assert pick is not None
    assert (pick.prim_path, pick.instance, pick.prototype_path) == ("/instancer", 9, "/prototypes/ball")
    assert renderer.pick(scene, camera, 400, 300, 5, 5) is None
    with pytest.raises(SettingsError, match="must lie in the 400x300 picture"):
        renderer.pick(scene, camera, 400, 300, 500, 5)


def test_aovs_name_what_is_there(renderer: FrameRenderer) -> None:
    scene = stacked([2.0])
    camera = Camera(np.eye(4), 50, 36, 27, f_stop=2.0, focus_distance_m=4.0, near_m=0.1)
    half = replace(scene, batches=(replace(scene.batches[0], poses=np.eye(4)[None] + 18 * np.eye(4, k=3)[None]),))
    frame = renderer.render(
        half, camera, FrameSettings(*SIZE, rays=4, aovs=("color", "depth", "coc", "prim_id", "face_id"))
    )
    left, right = (60, 40), (60, 120)
    assert np.isinf(frame.aovs["depth"][left])
    assert frame.aovs["depth"][right] == pytest.approx(2.0)
    assert frame.aovs["prim_id"][left] == 0
    assert frame.prim_paths[frame.aovs["prim_id"][right] - 1] == "/wall0"
    assert (frame.aovs["face_id"][left], frame.aovs["face_id"][right]) == (-1, 1)
    f_px, pupil_m = 50 / 36 * SIZE[0], 50 / 4000
    assert frame.aovs["coc"][right] == pytest.approx(f_px * pupil_m * (1 / 4 - 1 / 2), rel=1e-5)
    assert frame.aovs["coc"][left] == pytest.approx(f_px * pupil_m / 4, rel=1e-5)


def test_back_faces_are_culled_and_mirrored_instances_stay_front(renderer: FrameRenderer) -> None:
    wall = stacked([2.0]).batches[0]
    turned = np.diag([-1.0, 1, -1, 1])
    turned[2, 3] = -4.0  # half a turn about the wall's own axis: its back to the camera
    mirror = np.diag([-1.0, 1, 1, 1])
    camera = Camera(np.eye(4))
    settings = FrameSettings(*SIZE, rays=1)

    def coverage(**change: object) -> float:
        scene = Scene((replace(wall, **change),), (), DARK, ("/wall0",))  # type: ignore[arg-type]
        return float(renderer.render(scene, camera, settings).color[60, 80, 3])

    assert coverage(poses=turned[None]) == 0
    assert coverage(poses=turned[None], double_sided=True) == 1
    assert coverage(poses=mirror[None]) == 1
    assert coverage(poses=np.stack([mirror, turned])) == 1


def test_only_what_is_new_is_uploaded(peeler: Peeler, monkeypatch: pytest.MonkeyPatch) -> None:
    """A moved object keeps its geometry on the device; a new one is uploaded; one that left is freed."""
    scene, _ = spheres_over_checkerboard()
    peeler.load(scene)
    primitives = {id(draw.node.mesh.primitives[0]) for draw in peeler.index.draws}
    moved = replace(scene.batches[3], poses=scene.batches[3].poses + 0.5 * np.eye(4, k=3))
    peeler.load(replace(scene, batches=(*scene.batches[:3], moved, *scene.batches[4:])))
    assert {id(draw.node.mesh.primitives[0]) for draw in peeler.index.draws} == primitives
    ball = Batch(sphere((0, 0, -3), 0.2), Material(), np.eye(4)[None])
    peeler.load(replace(scene, batches=(*scene.batches[:-1], ball)))
    now = {id(draw.node.mesh.primitives[0]) for draw in peeler.index.draws}
    assert len(now - primitives) == 1
    assert len(peeler.index.graph.mesh_nodes) == len(scene.batches)


def test_an_empty_scene_is_an_empty_picture(renderer: FrameRenderer) -> None:
    for engine in ("lens", "accumulation", "pinhole"):
        camera = Camera(np.eye(4), f_stop=2.0, focus_distance_m=2.0)
        frame = renderer.render(Scene(), camera, FrameSettings(40, 30, engine=engine, rays=4))
        assert not frame.color.any()


def test_far_from_the_origin_nothing_shakes(renderer: FrameRenderer) -> None:
    """A scene 50 km from the origin, as layout in a world of real coordinates has it, is the same picture."""
    scene, camera = spheres_over_checkerboard()
    near = renderer.render(scene, camera, FrameSettings(*SIZE, engine="pinhole", rays=4, shading="unlit")).color
    away = np.eye(4)
    away[:3, 3] = [50_000.0, 300.0, -20_000.0]
    moved = tuple(replace(batch, poses=away @ batch.poses) for batch in scene.batches)
    there = replace(camera, world_from_camera=away @ camera.world_from_camera)
    far = renderer.render(
        replace(scene, batches=moved), there, FrameSettings(*SIZE, engine="pinhole", rays=4, shading="unlit")
    ).color
    assert np.mean(np.abs(near - far).max(-1) > 1e-3) < 2e-3


@pytest.mark.parametrize(
    ("f_stop", "focus_m", "focal_mm"), [(0.5, 0.001, 50), (1.0, 1.0, 200), (0.01, 2.0, 50), (64, 1e9, 5)]
)
def test_an_absurd_lens_makes_a_finite_picture(
    renderer: FrameRenderer, f_stop: float, focus_m: float, focal_mm: float
) -> None:
    """A blur wider than the picture, as a mistyped unit gives, still ends, and its light is light."""
    scene, camera = spheres_over_checkerboard()
    absurd = replace(camera, f_stop=f_stop, focus_distance_m=focus_m, focal_length_mm=focal_mm)
    frame = renderer.render(scene, absurd, FrameSettings(64, 48, rays=16))
    assert np.isfinite(frame.color).all()
    assert 0.01 < frame.color[..., :3].mean() < 2
    assert frame.color[..., 3].max() <= 1 + 1e-5


def tiles_in_one_plane() -> Batch:
    """Instances that lie over each other at the very same depth: the one drawn last is seen."""
    poses = np.tile(np.eye(4), (3, 1, 1))
    poses[:, :3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    poses[:, :3, 3] = [[0, -1.5, -9], [0.3, -1.5, -9], [0.9, -1.2, -9]]
    board = checkerboard(7, 6, 0.6, 0, 0, prim=25)
    white = Material(uses_display_color=True, base_color=(1, 1, 1))
    return Batch(board, white, poses, double_sided=True, instance_prim_ids=np.array([1, 2, 3], np.int32))


def test_cancellable_work_is_split_and_bit_identical(monkeypatch: pytest.MonkeyPatch) -> None:
    """Depths, colours, ids and shadows of draws that are cut into shares of their triangles and instances."""
    scene, camera = spheres_over_checkerboard()
    scene = replace(scene, batches=(*scene.batches, tiles_in_one_plane()))
    settings = FrameSettings(120, 90, rays=16, layers=4, aovs=("color", "depth", "prim_id", "face_id"))
    with FrameRenderer() as plain:
        whole = plain.render(scene, camera, settings)
    monkeypatch.setattr("render.layers.draw_splitter._TRIANGLES", 150)
    monkeypatch.setattr("render.layers.draw_splitter._LEAST_TRIANGLES", 100)
    monkeypatch.setattr("render.layers.draw_splitter._MOST_TRIANGLES", 150)
    drawn: list[int] = []
    draw = LayerRenderer._draw_range

    def counted(self: LayerRenderer, program: SourceProgram, share: DrawRange) -> None:
        drawn.append(share.triangles * share.instances)
        draw(self, program, share)

    monkeypatch.setattr(LayerRenderer, "_draw_range", counted)
    with FrameRenderer() as other, other.graphics.cancellation.cancel_when(lambda: False):
        pieces = other.render(scene, camera, settings)
    assert max(drawn) <= 150, "in depth, in colour and in the shadow maps"
    np.testing.assert_array_equal(pieces.color, whole.color)
    for name, values in whole.aovs.items():
        np.testing.assert_array_equal(pieces.aovs[name], values, err_msg=name)
