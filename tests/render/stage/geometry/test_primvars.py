"""Primvars reach the vertices they belong to, in every interpolation, plain and indexed."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Sdf, UsdGeom

from render import colour
from render.stage import StageReader
from tests.render.kits.stages import add_mesh, codes, new_stage, only_batch, read, set_primvar

# Two quads side by side: points 0 1 2 along the bottom, 3 4 5 along the top.
POINTS = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)]
CORNERS = [0, 1, 4, 3, 1, 2, 5, 4]
RED, GREEN, BLUE = (1, 0, 0), (0, 1, 0), (0, 0, 1)
PALETTE = [RED, GREEN, BLUE, (1, 1, 0), (0, 1, 1), (1, 0, 1), (0.5, 0.5, 0.5), (0.2, 0.3, 0.4)]

# Interpolation, and which palette entry corner (face, corner) takes.
CASES = {
    "constant": lambda face, corner: 0,
    "uniform": lambda face, corner: face,
    "varying": lambda face, corner: CORNERS[face * 4 + corner],
    "vertex": lambda face, corner: CORNERS[face * 4 + corner],
    "faceVarying": lambda face, corner: face * 4 + corner,
}
SIZES = {"constant": 1, "uniform": 2, "varying": 6, "vertex": 6, "faceVarying": 8}


@pytest.mark.parametrize("indexed", [False, True])
@pytest.mark.parametrize("interpolation", list(CASES))
def test_display_colour_is_on_the_right_corners(interpolation: str, indexed: bool) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", POINTS, [4, 4], CORNERS)
    size = SIZES[interpolation]
    order = np.arange(size)[::-1]
    values = [PALETTE[i] for i in (order if indexed else range(size))]
    primvar = set_primvar(mesh.GetPrim(), "displayColor", Sdf.ValueTypeNames.Color3fArray, interpolation, values)
    if indexed:
        primvar.SetIndices(np.argsort(order).astype(np.int32).tolist())
    geometry = only_batch(read(stage)).geometry
    assert geometry.colors is not None
    working = colour.to_working(np.array(PALETTE, np.float32))
    for triangle, face, fan in zip(geometry.triangles, geometry.face_ids, geometry.fan_ids, strict=True):
        for vertex, corner in zip(triangle, (0, fan + 1, fan + 2), strict=True):
            expected = working[CASES[interpolation](int(face), int(corner))]
            np.testing.assert_allclose(geometry.colors[vertex, :3], expected, atol=1e-5)
            np.testing.assert_allclose(geometry.positions[vertex], POINTS[CORNERS[face * 4 + corner]], atol=1e-6)


def test_opacity_is_alpha() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", POINTS, [4, 4], CORNERS)
    set_primvar(mesh.GetPrim(), "displayOpacity", Sdf.ValueTypeNames.FloatArray, "uniform", [0.25, 0.75])
    geometry = only_batch(read(stage)).geometry
    assert geometry.colors is not None
    alpha = geometry.colors[geometry.triangles, 3]
    np.testing.assert_allclose(alpha, np.where(geometry.face_ids == 0, 0.25, 0.75)[:, None].repeat(3, axis=1))


def test_constant_primvars_are_inherited() -> None:
    stage = new_stage()
    group = UsdGeom.Xform.Define(stage, "/group")
    set_primvar(group.GetPrim(), "displayColor", Sdf.ValueTypeNames.Color3fArray, "constant", [GREEN])
    add_mesh(stage, "/group/m")
    geometry = only_batch(read(stage)).geometry
    assert geometry.colors is not None
    np.testing.assert_allclose(geometry.colors[0, :3], colour.rgb_to_working(GREEN), atol=1e-6)


def test_without_a_colour_a_surface_is_grey() -> None:
    stage = new_stage()
    add_mesh(stage, "/m")
    batch = only_batch(read(stage))
    assert batch.material.uses_display_color
    assert batch.geometry.colors is not None
    np.testing.assert_allclose(batch.geometry.colors[0], [0.5, 0.5, 0.5, 1], atol=1e-3)


@pytest.mark.parametrize(("interpolation", "values"), [("vertex", [RED] * 3), ("faceVarying", [RED]), ("wrong", [RED])])
def test_a_primvar_that_is_too_short_is_left_out_and_named(interpolation: str, values: list) -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", POINTS, [4, 4], CORNERS)
    set_primvar(
        mesh.GetPrim(), "displayColor", Sdf.ValueTypeNames.Color3fArray, "vertex", values
    ).GetAttr().SetMetadata("interpolation", interpolation)
    reader = StageReader(stage)
    assert len(reader.read(0).batches) == 1
    if interpolation != "wrong":
        assert codes(reader) == {"bad_primvar_displayColor"}


def test_indices_out_of_range_are_named() -> None:
    stage = new_stage()
    mesh = add_mesh(stage, "/m", POINTS, [4, 4], CORNERS)
    primvar = set_primvar(mesh.GetPrim(), "displayColor", Sdf.ValueTypeNames.Color3fArray, "uniform", [RED, GREEN])
    primvar.SetIndices([0, 7])
    reader = StageReader(stage)
    assert len(reader.read(0).batches) == 1
    assert codes(reader) == {"bad_primvar_displayColor"}
