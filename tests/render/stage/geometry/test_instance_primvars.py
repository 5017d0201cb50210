"""Colours and opacities that prototypes inherit from point instancers."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

from render import colour
from render.frame import FrameRenderer
from render.model.camera import Camera
from render.model.frame_settings import FrameSettings
from render.model.scene import Batch
from render.shot.focus.visibility import visible_shares
from render.stage import StageReader
from tests.render.kits.stages import add_mesh, codes, new_stage, only_batch, read, set_primvar

T = Sdf.ValueTypeNames
RED, GREEN, BLUE = Gf.Vec3f(1, 0, 0), Gf.Vec3f(0, 1, 0), Gf.Vec3f(0, 0, 1)
NAMES = {
    tuple(row): name
    for row, name in zip(
        np.round(colour.to_working(np.eye(3, dtype=np.float32)).astype(np.float64), 2).tolist(), "rgb", strict=True
    )
}
"""Red, green and blue in the working space."""


def instancer(stage: Usd.Stage, path: str, prototypes: list[str], indices: list[int]) -> UsdGeom.PointInstancer:
    """Instances of prototypes in a row along X, two apart."""
    dots = UsdGeom.PointInstancer.Define(stage, path)
    dots.CreatePrototypesRel().SetTargets(prototypes)
    dots.CreateProtoIndicesAttr(indices)
    dots.CreatePositionsAttr([(2 * i, 0, 0) for i in range(len(indices))])
    return dots


def row(count: int = 3) -> tuple[Usd.Stage, Usd.Prim]:
    """A stage with squares in a row, and their instancer."""
    stage = new_stage()
    add_mesh(stage, "/square")
    return stage, instancer(stage, "/dots", ["/square"], [0] * count).GetPrim()


def instanced(stage: Usd.Stage) -> Batch:
    """The batch of the instances; the prototype itself is drawn beside them, as it stands outside of the instancer."""
    (batch,) = (batch for batch in read(stage).batches if batch.instance_numbers is not None)
    return batch


def named(colors: np.ndarray) -> str:
    """Letters of colours."""
    return "".join(NAMES[tuple(row)] for row in np.round(colors[:, :3].astype(np.float64), 2).tolist())


def colors(stage: Usd.Stage) -> tuple[str, list[float]]:
    """Colour and opacity of each instance, of vertices and instance together."""
    batch = instanced(stage)
    own = np.ones(4) if batch.geometry.colors is None else batch.geometry.colors[0]
    each = np.ones((len(batch.poses), 4)) if batch.instance_colors is None else batch.instance_colors
    return named(own * each), (own * each)[:, 3].tolist()


@pytest.mark.parametrize("interpolation", ["vertex", "varying"])
def test_each_instance_has_its_colour(interpolation: str) -> None:
    stage, dots = row()
    set_primvar(dots, "displayColor", T.Color3fArray, interpolation, [RED, GREEN, BLUE])
    set_primvar(dots, "displayOpacity", T.FloatArray, interpolation, [1.0, 0.5, 0.25])
    assert colors(stage) == ("rgb", [1, 0.5, 0.25])


@pytest.mark.parametrize("interpolation", ["constant", "uniform"])
def test_one_colour_is_for_all_instances(interpolation: str) -> None:
    stage, dots = row(2)
    set_primvar(dots, "displayColor", T.Color3fArray, interpolation, [GREEN])
    assert colors(stage) == ("gg", [1, 1])


def test_instancers_inherit_constant_primvars_themselves() -> None:
    stage = new_stage()
    add_mesh(stage, "/square")
    UsdGeom.Xform.Define(stage, "/group")
    instancer(stage, "/group/dots", ["/square"], [0])
    set_primvar(stage.GetPrimAtPath("/group"), "displayColor", T.Color3fArray, "constant", [BLUE])
    assert colors(stage) == ("b", [1])


def test_the_prototypes_own_colour_wins() -> None:
    stage, dots = row(2)
    set_primvar(dots, "displayColor", T.Color3fArray, "vertex", [RED, GREEN])
    set_primvar(stage.GetPrimAtPath("/square"), "displayColor", T.Color3fArray, "constant", [BLUE])
    assert colors(stage) == ("bb", [1, 1])


def test_indexed_colours_and_hidden_instances() -> None:
    stage, dots = row(4)
    primvar = set_primvar(dots, "displayColor", T.Color3fArray, "vertex", [RED, GREEN])
    primvar.SetIndices([1, 0, 0, 1])
    UsdGeom.PointInstancer(dots).InvisId(1, Usd.TimeCode.Default())
    assert colors(stage) == ("grg", [1, 1, 1])


def test_of_nested_instancers_the_inner_one_wins() -> None:
    stage = new_stage()
    add_mesh(stage, "/square")
    inner = instancer(stage, "/inner", ["/square"], [0, 0]).GetPrim()
    outer = instancer(stage, "/outer", ["/inner"], [0, 0]).GetPrim()
    set_primvar(outer, "displayColor", T.Color3fArray, "vertex", [RED, GREEN])
    set_primvar(outer, "displayOpacity", T.FloatArray, "vertex", [0.5, 0.25])
    nested = max(read(stage).batches, key=lambda batch: len(batch.poses))
    assert nested.instance_colors is not None
    assert named(nested.instance_colors) == "rrgg"
    assert nested.instance_colors[:, 3].tolist() == [0.5, 0.5, 0.25, 0.25]
    set_primvar(inner, "displayColor", T.Color3fArray, "vertex", [BLUE, RED])
    nested = max(read(stage).batches, key=lambda batch: len(batch.poses))
    assert nested.instance_colors is not None
    assert named(nested.instance_colors) == "brbr"
    assert nested.instance_colors[:, 3].tolist() == [0.5, 0.5, 0.25, 0.25]


def test_colours_change_over_time() -> None:
    stage, dots = row(1)
    primvar = set_primvar(dots, "displayColor", T.Color3fArray, "vertex", [RED])
    primvar.Set([BLUE], 10)
    primvar.Set([RED], 0)
    reader = StageReader(stage)
    first, last = (
        next(batch for batch in reader.read(time).batches if batch.instance_colors is not None) for time in (0, 10)
    )
    assert first.geometry is last.geometry
    assert first.instance_colors is not None
    assert last.instance_colors is not None
    assert named(first.instance_colors) + named(last.instance_colors) == "rb"


@pytest.mark.parametrize(
    ("kind", "value", "indices"),
    [
        (T.Color3fArray, [RED, GREEN], None),
        (T.FloatArray, [1.0, 2.0, 3.0], None),
        (T.Color3fArray, [RED], [0, 5, 0]),
        (T.Color3fArray, [RED], [0, -1, 0]),
        (T.Color3fArray, [], None),
    ],
)
def test_values_that_do_not_fit_are_a_finding(
    kind: Sdf.ValueTypeName, value: list[object], indices: list[int] | None
) -> None:
    stage, dots = row()
    primvar = set_primvar(dots, "displayColor", kind, "vertex", value)
    if indices:
        primvar.SetIndices(indices)
    reader = StageReader(stage)
    batches = reader.read(0).batches
    assert sum(len(batch.poses) for batch in batches if batch.instance_numbers is not None) == 3
    assert codes(reader) == {"bad_primvar_displayColor"}


@pytest.mark.gl
@pytest.mark.parametrize("engine", ["pinhole", "lens"])
def test_pictures_show_the_instances_colours(renderer: FrameRenderer, engine: str) -> None:
    stage, dots = row()
    stage.GetPrimAtPath("/square").SetSpecifier(Sdf.SpecifierOver)
    set_primvar(dots, "displayColor", T.Color3fArray, "vertex", [RED, GREEN, BLUE])
    set_primvar(dots, "displayOpacity", T.FloatArray, "vertex", [1.0, 0.5, 0.0])
    pose = np.eye(4)
    pose[:3, 3] = 2.5, 0.5, 5
    settings = FrameSettings(60, 20, engine=engine, rays=4, supersample=1, shading="unlit")
    frame = renderer.render(read(stage), Camera(pose, 30, 36, 12), settings).color
    red, green, clear = frame[10, [10, 30, 50]]
    assert named(np.stack([red, green / 0.5])) == "rg"
    assert (red[3], green[3], clear[3]) == (1, pytest.approx(0.5, abs=1e-3), 0)


def test_clear_instances_let_focus_points_be_seen() -> None:
    stage, dots = row()
    stage.GetPrimAtPath("/square").SetSpecifier(Sdf.SpecifierOver)
    set_primvar(dots, "displayOpacity", T.FloatArray, "vertex", [1.0, 0.5, 0.0])
    pose = np.eye(4)
    pose[:3, 3] = 2.5, 0.5, 500
    points = np.array([[x + 0.5, 0.5, -1] for x in (0, 2, 4)])
    np.testing.assert_allclose(visible_shares(read(stage), Camera(pose), points), [0, 0.5, 1], atol=1e-6)
    assert only_batch(read(stage)).instance_colors is not None
