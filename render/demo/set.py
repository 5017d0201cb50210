"""The set: where everything stands that does not move. The shot's street runs along -Z from the camera at the origin."""

from __future__ import annotations

import numpy as np
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, Vt

from render.demo import bulbs, foliage, props
from render.demo.author import instance, stand, units, write_part
from render.demo.houses import House, house_front, window
from render.demo.places import LAMP_POSTS, LANTERNS, NEON_PLACE, TRAM_PLACE
from render.demo.shapes.kit import ball
from render.demo.shapes.mesh import Array, Mesh, rotation
from render.demo.street import FAR_Z_M, KERB_M, WALL_M, street
from render.demo.tram import tram

SET, LIBRARY = "/World/Set", "/Props"
CLOTH = ("AwningRed", "AwningTeal", "Cloth", "Leaf")

TABLES = ((2.55, -6.3), (3.15, -7.9), (2.75, -9.7), (3.3, -11.6))

LEFT_HOUSES = (
    House(5.2, 1, 3, "PlasterBlue", "AwningTeal"),
    House(4.6, 2, 3, "PlasterOchre", "AwningRed"),
    House(5.6, 1, 4, "PlasterBlue", None),
    House(4.4, 2, 2, "PlasterOchre", "AwningTeal"),
    House(5.4, 1, 3, "PlasterBlue", "AwningRed", shop=False),
    House(5.0, 2, 3, "PlasterOchre", "AwningTeal"),
)
RIGHT_HOUSES = (
    House(4.8, 2, 3, "PlasterOchre", "AwningRed"),
    House(5.4, 2, 4, "PlasterBlue", "AwningRed"),
    House(4.6, 1, 3, "PlasterOchre", "AwningTeal"),
    House(5.2, 2, 3, "PlasterBlue", None, shop=False),
    House(5.0, 2, 3, "PlasterOchre", "AwningRed"),
    House(5.2, 2, 3, "PlasterBlue", "AwningTeal"),
)
END_HOUSES = (House(4.4, 3, 3, "PlasterOchre", "AwningRed"), House(4.2, 2, 3, "PlasterBlue", "AwningTeal"))
# Lighting of the upper windows, in turn.
PANES = ("WindowWarm", "WindowDark", "WindowDim", "WindowWarm", "WindowDark", "WindowWarm", "WindowDim")


def write_set(stage: Usd.Stage) -> None:
    """Authors the whole set, and the library of props that it instances."""
    Usd.ModelAPI(UsdGeom.Xform.Define(stage, SET).GetPrim()).SetKind(Kind.Tokens.group)
    _write_library(stage)
    write_part(stage, f"{SET}/Street", street())
    write_part(stage, f"{SET}/Wires", {"Rubber": bulbs.wires()})
    _write_houses(stage)
    _write_furniture(stage)
    _write_bulbs(stage)
    _write_fruit(stage)
    _write_foreground(stage)


def _write_library(stage: Usd.Stage) -> None:
    """Author the props as class prims, which are visible only as instances."""
    stage.CreateClassPrim(LIBRARY)
    library: dict[str, dict[str, Mesh]] = {
        "LampPost": props.lamp_post(),
        "Table": props.cafe_table(),
        "Chair": props.bentwood_chair(),
        "Lantern": props.paper_lantern(),
        "Planter": {**props.planter(), "Leaf": foliage.clipped_ball(0.27, 260, 3).at(0, 1.12, 0)},
        **{pane: window(pane) for pane in sorted(set(PANES))},
    }
    for name, meshes in library.items():
        write_part(stage, f"{LIBRARY}/{name}", meshes, CLOTH)


def _write_houses(stage: Usd.Stage) -> None:
    """Both sides of the street and its end, with their windows as instances."""
    UsdGeom.Scope.Define(stage, f"{SET}/Houses")
    UsdGeom.Scope.Define(stage, f"{SET}/Windows")
    number = 0
    for houses, yaw, (x, z) in (
        (LEFT_HOUSES, 90.0, (-WALL_M, 0.5)),
        (RIGHT_HOUSES, -90.0, (WALL_M, FAR_Z_M - 1.0)),
        (END_HOUSES, 0.0, (-4.3, FAR_Z_M)),
    ):
        walk = rotation(y=yaw)[:3, :3]
        corner = np.array([x, 0.0, z])
        for house in houses:
            prim = write_part(stage, f"{SET}/Houses/House{number:02d}", house_front(house), CLOTH)
            stand(prim, corner, yaw=yaw)
            for k, place in enumerate(house.window_places()):
                pane = PANES[(3 * number + 2 * k + k // house.bays) % len(PANES)]
                path = f"{SET}/Windows/House{number:02d}_{k:02d}"
                instance(stage, path, f"{LIBRARY}/{pane}", corner + walk @ place, yaw=yaw)
            corner = corner + walk @ [house.width_m, 0, 0]
            number += 1


def _write_furniture(stage: Usd.Stage) -> None:
    """Lamp posts, the café, the market stall, the neon sign and the tram."""
    root = f"{SET}/Furniture"
    UsdGeom.Scope.Define(stage, root)
    for k, (x, z) in enumerate(LAMP_POSTS):
        instance(stage, f"{root}/LampPost{k}", f"{LIBRARY}/LampPost", [x, KERB_M, z])
    for k, (x, z) in enumerate(TABLES):
        instance(stage, f"{root}/Table{k}", f"{LIBRARY}/Table", [x, KERB_M if x > 2.7 else 0.0, z], yaw=40 * k)
        for side, (dx, dz, yaw) in enumerate(((-0.52, 0.12, 80), (0.42, -0.38, -50))):
            place = [x + dx, KERB_M if x + dx > 2.7 else 0.0, z + dz]
            instance(stage, f"{root}/Chair{k}_{side}", f"{LIBRARY}/Chair", place, yaw=yaw + 13 * k)
    for k, (x, y, z) in enumerate(LANTERNS):
        instance(stage, f"{root}/Lantern{k}", f"{LIBRARY}/Lantern", [x, y, z], scale=1.0 - 0.12 * (k % 2))
    for k, (x, z) in enumerate(((-3.6, -8.3), (3.75, -10.6), (-3.6, -12.2), (3.7, -14.6), (-3.6, -18.2))):
        instance(stage, f"{root}/Planter{k}", f"{LIBRARY}/Planter", [x, KERB_M, z], yaw=70 * k)
    stand(write_part(stage, f"{root}/Stall", props.market_stall(), CLOTH), [-2.15, 0, -6.2], yaw=14)
    stand(write_part(stage, f"{root}/Neon", bulbs.neon_cup()), NEON_PLACE, yaw=-8)
    stand(write_part(stage, f"{root}/Tram", tram()), TRAM_PLACE)
    stand(write_part(stage, f"{root}/Manhole", props.manhole()), [1.55, -0.012, -6.4])


def _write_instancer(
    stage: Usd.Stage, path: str, prototypes: dict[str, dict[str, Mesh]], which: Array, places: Array
) -> UsdGeom.PointInstancer:
    """A PointInstancer whose prototypes are its children; ``places`` are ``(n, 3)`` metres."""
    instancer = UsdGeom.PointInstancer.Define(stage, path)
    for name, meshes in prototypes.items():
        write_part(stage, f"{path}/Prototypes/{name}", meshes, CLOTH)
        instancer.CreatePrototypesRel().AddTarget(Sdf.Path(f"{path}/Prototypes/{name}"))
    instancer.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy(which.astype(np.int32)))
    instancer.CreatePositionsAttr(Vt.Vec3fArray.FromNumpy(units(places).astype(np.float32)))
    return instancer


def _finish_instancer(instancer: UsdGeom.PointInstancer) -> None:
    extent = instancer.ComputeExtentAtTime(Usd.TimeCode.Default(), Usd.TimeCode.Default())
    instancer.CreateExtentAttr(extent)


def _write_bulbs(stage: Usd.Stage) -> None:
    """The strings' bulbs: warm, with a coloured one here and there."""
    places = np.concatenate([string.bulbs() for string in bulbs.strings()])
    which = np.array(bulbs.PATTERN)[np.arange(len(places)) % len(bulbs.PATTERN)]
    kinds = {kind: bulbs.bulb(kind) for kind in bulbs.KINDS}
    _finish_instancer(_write_instancer(stage, f"{SET}/Bulbs", kinds, which, places))


def _write_fruit(stage: Usd.Stage) -> None:
    """Oranges and apples in the stall's crates."""
    places = props.fruit_places()
    crate = np.searchsorted([-0.36, 0.36], places[:, 0])
    kinds = {"Orange": props.fruit("Fruit"), "Apple": props.fruit("Apple")}
    instancer = _write_instancer(stage, f"{SET}/Furniture/Stall/FruitHeap", kinds, np.where(crate == 1, 1, 0), places)
    turns = np.random.default_rng(9).uniform(-40, 40, (len(places), 3))
    instancer.CreateOrientationsAttr(_quaternions(turns))
    _finish_instancer(instancer)


def _write_foreground(stage: Usd.Stage) -> None:
    """Write the foreground that the camera passes closely, out of focus: a leafy branch and the café's railing."""
    root = f"{SET}/Foreground"
    UsdGeom.Scope.Define(stage, root)
    write_part(stage, f"{root}/Branch", {"Wood": foliage.branch()})
    _write_leaves(stage, f"{root}/Leaves", *foliage.leaf_poses())
    railing = f"{root}/Railing"
    stand(write_part(stage, railing, {"Iron": foliage.railing()}), [-1.60, 0.0, -0.72], yaw=5)
    _write_leaves(stage, f"{railing}/Ivy", *foliage.ivy_poses())
    fairy = {"BulbAmber": {"BulbAmber": ball(0.006, 10, 7)}}
    places = foliage.ivy_lights()
    _finish_instancer(_write_instancer(stage, f"{railing}/FairyLights", fairy, np.zeros(len(places)), places))


def _write_leaves(stage: Usd.Stage, path: str, places: Array, turns: Array, scales: Array) -> None:
    leaves = _write_instancer(stage, path, {"Leaf": {"Leaf": foliage.leaf()}}, np.zeros(len(places)), places)
    leaves.CreateOrientationsAttr(_quaternions(turns))
    leaves.CreateScalesAttr(Vt.Vec3fArray.FromNumpy(np.repeat(scales[:, None], 3, 1).astype(np.float32)))
    _finish_instancer(leaves)


def _quaternions(turns: Array) -> Vt.QuathArray:
    """Half-precision quaternions of rotations in degrees about X, then Y, then Z."""
    rotations = [
        Gf.Rotation((1, 0, 0), x) * Gf.Rotation((0, 1, 0), y) * Gf.Rotation((0, 0, 1), z) for x, y, z in turns.tolist()
    ]
    return Vt.QuathArray([Gf.Quath(turn.GetQuat()) for turn in rotations])
