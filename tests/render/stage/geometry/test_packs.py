"""Surfaces that are read together, against the same ones read one by one."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from pxr import Sdf, Usd, UsdGeom

from render.stage.findings import FindingLog
from render.stage.geometry.closed import find_closed
from render.stage.geometry.packs import pack_surfaces
from render.stage.geometry.polygons import Polygons, weld
from render.stage.geometry.reading import ShapeSource, read_shapes
from render.stage.geometry.shape import PrimvarNames, Shape
from render.stage.geometry.skinning import Skeletons
from tests.render.kits.stages import add_mesh, new_stage, set_primvar

T = Sdf.ValueTypeNames
BOX_POINTS = [(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]
BOX_CORNERS = [0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5]
NAMES = PrimvarNames(uv="st", color="displayColor", opacity="displayOpacity")


def box(stage: Usd.Stage, name: str, scheme: str = "none", faces: int = 6) -> UsdGeom.Mesh:
    return add_mesh(stage, f"/{name}", BOX_POINTS, [4] * faces, BOX_CORNERS[: 4 * faces], scheme)


def mixed_stage() -> Usd.Stage:
    """Surfaces of all kinds, three of each, with what differs between them in turns."""
    stage = new_stage()
    for turn in range(3):
        box(stage, f"closed{turn}")
        box(stage, f"open{turn}", faces=5)
        box(stage, f"smooth{turn}", "catmullClark").CreateHoleIndicesAttr([turn, 9] if turn else [])
        box(stage, f"left{turn}").CreateOrientationAttr("leftHanded")
        authored = box(stage, f"authored{turn}")
        authored.CreateNormalsAttr([(0, 1, 0)] * (8 if turn else 24))
        authored.SetNormalsInterpolation("vertex" if turn else "faceVarying")
        corners = box(stage, f"corners{turn}").GetPrim()
        st = np.random.default_rng(turn).integers(0, 2, (24, 2)).astype(np.float32)
        set_primvar(corners, "st", T.TexCoord2fArray, "faceVarying", [tuple(map(float, row)) for row in st])
        count, interpolation = ((1, "constant"), (6, "uniform"), (8, "vertex"))[turn]
        set_primvar(corners, "displayColor", T.Color3fArray, interpolation, [(0.1 * i, 0.5, 1) for i in range(count)])
        set_primvar(corners, "displayOpacity", T.FloatArray, "uniform", [0.1 * i for i in range(6)])
        UsdGeom.Sphere.Define(stage, f"/sphere{turn}").CreateRadiusAttr(1.0 + turn)
        add_mesh(stage, f"/bad{turn}", corners=(0, 1, 2, 9))
        add_mesh(stage, f"/empty{turn}", counts=(2, 2))
        add_mesh(stage, f"/none{turn}", counts=(), corners=())
        add_mesh(stage, f"/concave{turn}", [(2, 0, 0), (0.2, 0.2, 0), (0, 2, 0), (0, 0, 0)])
        apart = [BOX_POINTS[corner] for corner in BOX_CORNERS]
        add_mesh(stage, f"/seams{turn}", np.array(apart) * (1 + turn), [4] * 6, range(24))
    return stage


def sources(stage: Usd.Stage) -> list[ShapeSource]:
    return [
        ShapeSource(prim, NAMES if number % 2 else PrimvarNames(uv=None), judged=number % 5 != 0, seams=number % 3 != 0)
        for number, prim in enumerate(stage.Traverse())
    ]


def arrays(shape: Shape) -> list[object]:
    return [getattr(shape, field.name) for field in fields(shape)]


def same(one: object, other: object) -> bool:
    if isinstance(one, np.ndarray) and isinstance(other, np.ndarray):
        return one.dtype == other.dtype and np.array_equal(one, other)
    return one is None and other is None


def test_surfaces_read_together_are_as_those_read_one_by_one() -> None:
    stage = mixed_stage()
    time, skeletons = Usd.TimeCode.Default(), Skeletons(stage)
    log, log_alone = FindingLog(), FindingLog()
    together = read_shapes(sources(stage), time, skeletons, log)
    alone = [read_shapes([source], time, skeletons, log_alone)[0] for source in sources(stage)]
    assert [shape is None for shape in together] == [shape is None for shape in alone]
    pairs = [(a, b) for a, b in zip(together, alone, strict=True) if a is not None and b is not None]
    assert len(pairs) == 27
    assert all(same(a, b) for pair in pairs for a, b in zip(*map(arrays, pair), strict=True))
    assert any(a.closed_box is not None for a, _ in pairs)
    assert any(a.closed_box is None for a, _ in pairs)
    assert sorted(map(str, log.as_list())) == sorted(map(str, log_alone.as_list()))
    assert {f.code for f in log.as_list()} >= {"bad_geometry", "no_faces", "concave_faces", "no_texture_coordinates"}


def test_each_surface_of_a_pack_is_judged_by_itself() -> None:
    points, corners = np.array(BOX_POINTS, np.float32), np.array(BOX_CORNERS, np.int32)
    whole = Polygons(points, np.full(6, 4, np.int32), corners)
    lid_off = Polygons(points, np.full(5, 4, np.int32), corners[:20])
    lid = Polygons(points, np.full(1, 4, np.int32), corners[20:])
    inwards = Polygons(points, np.full(6, 4, np.int32), corners[::-1].copy())
    holed = Polygons(points, np.full(6, 4, np.int32), corners, holes=np.array([2], np.int32))
    far_hole = Polygons(points, np.full(6, 4, np.int32), corners, holes=np.array([6], np.int32))
    apart = Polygons(points[corners] * 100, np.full(6, 4, np.int32), np.arange(24, dtype=np.int32))
    pack = pack_surfaces([lid_off, lid, inwards, whole, holed, apart, far_hole, apart])
    seams = np.array([True] * 7 + [False])
    assert find_closed(pack, seams).tolist() == [False, False, False, True, False, True, True, False]


def test_welding_by_points_alone_gives_what_sorting_gives() -> None:
    corners = np.random.default_rng(3).integers(0, 40, 300).astype(np.int32)
    polygons = Polygons(np.zeros((50, 3), np.float32), np.full(100, 3, np.int32), corners)
    _, first, vertex = np.unique(corners, return_index=True, return_inverse=True)
    found_first, found_vertex = weld(polygons, [])
    assert np.array_equal(found_first, first)
    assert np.array_equal(found_vertex, vertex)
