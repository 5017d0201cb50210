"""Shapes that the demo's geometry kit builds: closed, outward and of the right size."""

from __future__ import annotations

import numpy as np
import pytest

from render.demo import bulbs, foliage, houses, mara, pip, props, street, tram
from render.demo.shapes.kit import ball, box, hoop, lathe, ring, rounded_box, smooth_curve, tube
from render.demo.shapes.mesh import Mesh, rotation

CIRCLE = np.stack([np.cos(a := np.linspace(0, 2 * np.pi, 64, endpoint=False)), 0 * a, np.sin(a)], axis=1)


def fan_triangles(mesh: Mesh) -> np.ndarray:
    return np.concatenate([mesh.quads[:, [0, 1, 2]], mesh.quads[:, [0, 2, 3]], mesh.triangles])


def enclosed_volume(mesh: Mesh) -> float:
    """By the divergence theorem; positive only if the faces of a closed mesh are wound outward."""
    a, b, c = (mesh.points[corner] for corner in fan_triangles(mesh).T)
    return float(np.einsum("ni,ni->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("mesh", "volume"),
    [
        (ball(0.5, 64, 40), 4 / 3 * np.pi * 0.5**3),
        (box([1, 2, 3]), 6.0),
        (rounded_box([1, 2, 3], 1e-4), 6.0),
        (rounded_box([1, 1, 1], 0.5, 12), None),
        (lathe([[0, 0], [0.3, 0], [0.3, 2], [0, 2]], 96), np.pi * 0.3**2 * 2),
        (ring(1.0, 0.2, 128, 48), 2 * np.pi**2 * 0.2**2),
        (hoop(CIRCLE, 0.2, 48), 2 * np.pi**2 * 0.2**2),
        (tube([[0, 0, 0], [0, 1, 0], [0, 2, 0]], 0.1, 64), np.pi * 0.1**2 * 2 + 4 / 3 * np.pi * 0.1**3),
    ],
    ids=["ball", "box", "sharp rounded box", "very round box", "cylinder", "ring", "hoop", "capsule"],
)
def test_a_solid_encloses_its_volume(mesh: Mesh, volume: float | None) -> None:
    """Facets cut off less than 3 % at these resolutions."""
    if volume is None:  # between the ball that fits in it and the cube
        assert np.pi / 6 < enclosed_volume(mesh) < 1
    else:
        assert enclosed_volume(mesh) == pytest.approx(volume, rel=0.03)


def test_a_mirrored_solid_stays_outside_out() -> None:
    mirrored = rounded_box([1, 2, 3], 0.2).scale(-1, 1, 1)
    assert enclosed_volume(mirrored) == pytest.approx(enclosed_volume(rounded_box([1, 2, 3], 0.2)))


def test_rotation_turns_x_before_y_before_z() -> None:
    turned = rotation(x=90, y=90)[:3, :3] @ [0, 1, 0]
    assert turned == pytest.approx([1, 0, 0])  # Y goes to Z about X, then Z to X about Y


def test_a_smooth_curve_passes_its_controls() -> None:
    controls = np.array([[0, 0], [1, 2], [3, 1], [4, 4]], float)
    assert smooth_curve(controls, 31)[::10] == pytest.approx(controls)


ASSETS = {
    "street": street.street(),
    "house": houses.house_front(houses.House(5.0, 2, 3, "PlasterBlue", "AwningRed")),
    "window": houses.window("WindowWarm"),
    "tram": tram.tram(),
    "bulb": bulbs.bulb("BulbWarm"),
    "neon": bulbs.neon_cup(),
    "lamp post": props.lamp_post(),
    "table": props.cafe_table(),
    "chair": props.bentwood_chair(),
    "lantern": props.paper_lantern(),
    "stall": props.market_stall(),
    "planter": props.planter(),
    "tree": {"Leaf": foliage.clipped_ball(0.27, 60, 3)},
    "railing": {"Iron": foliage.railing()},
    **{f"pip {name}": meshes for name, meshes in pip.parts().items()},
    **{f"mara {name}": meshes for name, meshes in mara.parts().items()},
}


@pytest.mark.parametrize("name", ASSETS)
def test_normals_are_unit_and_agree_with_the_winding(name: str) -> None:
    """A face wound against its normals would be lit from the wrong side, or culled; 2 % allow for tight bends of tubes."""
    for look, mesh in ASSETS[name].items():
        assert np.linalg.norm(mesh.normals, axis=1) == pytest.approx(1, abs=1e-6), look
        corners = fan_triangles(mesh)
        a, b, c = (mesh.points[corner] for corner in corners.T)
        facing = np.cross(b - a, c - a)
        area = np.linalg.norm(facing, axis=1)
        agrees = np.einsum("ni,ni->n", facing, mesh.normals[corners].sum(axis=1)) >= 0
        assert (agrees | (area < 1e-9)).mean() > 0.98, look
        assert (area > 1e-10).mean() > 0.98, look
