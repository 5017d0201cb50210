"""Implicit shapes have the size, axis and outward faces that UsdGeom gives them."""

from __future__ import annotations

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from render import colour
from tests.render.kits.stages import T, facing, new_stage, only_batch, read, set_primvar, world_points

# Type, attributes, extent on its axis Z (low, high), volume.
SHAPES = [
    ("Sphere", {"radius": 2.0}, [(-2, -2, -2), (2, 2, 2)], 4 / 3 * np.pi * 8),
    ("Cube", {"size": 3.0}, [(-1.5, -1.5, -1.5), (1.5, 1.5, 1.5)], 27.0),
    ("Cylinder", {"radius": 0.5, "height": 4.0}, [(-0.5, -0.5, -2), (0.5, 0.5, 2)], np.pi * 0.25 * 4),
    (
        "Cylinder_1",
        {"radiusBottom": 2.0, "radiusTop": 1.0, "height": 3.0},
        [(-2, -2, -1.5), (2, 2, 1.5)],
        np.pi * (4 + 2 + 1),
    ),
    ("Cone", {"radius": 1.0, "height": 2.0}, [(-1, -1, -1), (1, 1, 1)], np.pi * 2 / 3),
    ("Capsule", {"radius": 0.5, "height": 1.0}, [(-0.5, -0.5, -1), (0.5, 0.5, 1)], np.pi * (0.25 + 0.5 / 3)),
    (
        "Capsule_1",
        {"radiusBottom": 0.5, "radiusTop": 0.5, "height": 1.0},
        [(-0.5, -0.5, -1), (0.5, 0.5, 1)],
        np.pi * (0.25 + 0.5 / 3),
    ),
]
# Where Z goes for each axis, as rows of what to take.
AXES = {"X": [2, 1, 0], "Y": [0, 2, 1], "Z": [0, 1, 2]}


@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
@pytest.mark.parametrize(("kind", "measures", "extent", "volume"), SHAPES)
def test_a_solid_has_its_extent_and_volume(kind: str, measures: dict, extent: list, volume: float, axis: str) -> None:
    stage = new_stage()
    prim = stage.DefinePrim("/shape", kind)
    for name, value in measures.items():
        prim.GetAttribute(name).Set(value)
    if prim.HasAttribute("axis"):
        prim.GetAttribute("axis").Set(axis)
    batch = only_batch(read(stage))
    points = world_points(batch)
    order = AXES[axis]
    # A polyhedron of 64 steps around falls short of the round shape by (2 pi / 64)^2 / 6 of its area, 0.2 %.
    np.testing.assert_allclose(np.sort([points.min(0), points.max(0)], axis=0), np.array(extent)[:, order], rtol=0.003)
    corners = points[batch.geometry.triangles]
    measured = np.sum(np.cross(corners[:, 0], corners[:, 1]) * corners[:, 2]) / 6
    assert measured == pytest.approx(volume, rel=0.006)


@pytest.mark.parametrize(("axis", "size", "normal"), [("X", (0, 3, 2), 0), ("Y", (2, 0, 3), 1), ("Z", (2, 3, 0), 2)])
def test_a_planes_width_and_length_lie_as_usd_says(axis: str, size: tuple, normal: int) -> None:
    stage = new_stage()
    plane = UsdGeom.Plane.Define(stage, "/plane")
    plane.CreateWidthAttr(2.0)
    plane.CreateLengthAttr(3.0)
    plane.CreateAxisAttr(axis)
    batch = only_batch(read(stage))
    np.testing.assert_allclose(np.ptp(world_points(batch), axis=0), size, atol=1e-6)
    np.testing.assert_allclose(facing(batch), np.eye(3)[[normal, normal]], atol=1e-6)
    assert batch.double_sided


def test_round_shapes_have_round_normals() -> None:
    stage = new_stage()
    UsdGeom.Sphere.Define(stage, "/ball").CreateRadiusAttr(5.0)
    geometry = only_batch(read(stage)).geometry
    np.testing.assert_allclose(geometry.normals, geometry.positions / 5, atol=1e-5)


CUBE_POINTS = [(1, 1, 1), (-1, 1, 1), (-1, -1, 1), (1, -1, 1), (-1, -1, -1), (-1, 1, -1), (1, 1, -1), (1, -1, -1)]
CUBE_FACES = [(0, 0, 1), (0, 0, -1), (0, 1, 0), (0, -1, 0), (1, 0, 0), (-1, 0, 0)]


@pytest.mark.parametrize(("interpolation", "places"), [("vertex", CUBE_POINTS), ("uniform", CUBE_FACES)])
def test_the_primvars_of_a_cube_follow_hydras_order(interpolation: str, places: list) -> None:
    """Colours are coded: each corner or face has that of its own place."""
    stage = new_stage()
    coded = [Gf.Vec3f(*(0.5 + 0.25 * x for x in place)) for place in places]
    cube = UsdGeom.Cube.Define(stage, "/cube").GetPrim()
    set_primvar(cube, "displayColor", T.Color3fArray, interpolation, coded)
    batch = only_batch(read(stage))
    assert batch.geometry.colors is not None
    shown = batch.geometry.colors[batch.geometry.triangles, :3]
    corners = batch.geometry.positions[batch.geometry.triangles]
    own = corners if interpolation == "vertex" else np.repeat(facing(batch)[:, None], 3, axis=1)
    np.testing.assert_allclose(shown, colour.to_working((0.5 + 0.25 * own).astype(np.float32)), atol=1e-5)


def test_a_type_that_is_unknown_is_drawn_as_its_fallback() -> None:
    stage = new_stage()
    stage.SetMetadata("fallbackPrimTypes", {"BoxOfOurs": Vt.TokenArray(["BoxThatNobodyHas", "Cube"])})
    stage.DefinePrim("/box", "BoxOfOurs").CreateAttribute("size", T.Double).Set(3.0)
    layer = stage.GetRootLayer().ExportToString()
    opened = Sdf.Layer.CreateAnonymous(".usda")
    opened.ImportFromString(layer)
    points = world_points(only_batch(read(Usd.Stage.Open(opened))))
    np.testing.assert_allclose(np.ptp(points, axis=0), 3.0)
