"""House fronts: plaster walls, cornices, shop fronts with awnings, and the window prop that they share.

A front is built facing +Z with its left foot at the origin, and turned into the street by the set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from render.demo.shapes.kit import box, plate, rounded_box, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge

SHOP_HEIGHT_M, STOREY_M = 3.0, 2.75
WINDOW_M = (0.92, 1.5)


@dataclass(frozen=True)
class House:
    """One house front.

    Attributes:
        width_m: along the street.
        storeys: above the shop.
        bays: windows on each storey.
        wall: look of its plaster.
        awning: look of the awning over its shop, if it has one.
        shop: whether its shop is lit.
    """

    width_m: float
    storeys: int
    bays: int
    wall: str
    awning: str | None = None
    shop: bool = True

    @property
    def height_m(self) -> float:
        """From the ground to the eaves."""
        return SHOP_HEIGHT_M + self.storeys * STOREY_M

    def window_places(self) -> Array:
        """``(n, 3)`` metres: the middle of each window's foot, storey by storey from the left."""
        x = (np.arange(self.bays) + 0.5) / self.bays * self.width_m
        y = SHOP_HEIGHT_M + 0.75 + np.arange(self.storeys) * STOREY_M
        grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        return np.concatenate([grid, np.zeros((len(grid), 1))], axis=1)


def _scalloped_awning(width: float) -> Mesh:
    """A sloping cloth roof with a scalloped valance, hung a little between its ribs."""
    reach, drop, valance = 1.05, 0.5, 0.24

    def shape(u: Array, v: Array) -> Array:
        # v runs from the valance's hem up and back to the wall.
        hang = 0.022 * (np.cos(u * 2 * np.pi * 6) - 1)
        cloth = np.clip((v - 0.2) / 0.8, 0, 1)
        scallop = 0.055 * np.abs(np.sin(u * np.pi * round(width / 0.25)))
        skirt = np.clip(1 - v / 0.2, 0, 1) * (valance - 0.055 + scallop)
        y = cloth * drop - skirt + hang * np.sin(np.pi * np.clip(cloth, 0, 1))
        return np.stack([u * width, y, reach * (1 - cloth)], axis=-1)

    cloth = surface(shape, 81, 16)
    return Mesh(cloth.points, cloth.normals, cloth.points[:, [0, 2]], cloth.quads, cloth.triangles)


def _cornice(width: float, y: float) -> Mesh:
    """Eaves: two mouldings and a row of dentils."""
    mouldings = [
        rounded_box([width + 0.1, 0.14, 0.36], 0.03, 1).at(width / 2, y - 0.07, 0.14),
        rounded_box([width, 0.1, 0.22], 0.02, 1).at(width / 2, y - 0.34, 0.08),
    ]
    dentils = [box([0.09, 0.12, 0.12]).at(x, y - 0.21, 0.1) for x in np.arange(0.12, width - 0.05, 0.22)]
    return merge([*mouldings, *dentils])


def _pane(number: int, width: float, height: float) -> Mesh:
    """One of a shop window's three panes, which share one picture."""
    pane = plate(width, height)
    return Mesh(pane.points, pane.normals, (pane.uvs + np.array([number, 0])) / [3, 1], pane.quads)


def _shop_front(house: House) -> dict[str, Mesh]:
    """Pilasters, fascia, a glazed window and a panelled door."""
    width = house.width_m
    door, glass = 0.95, width - 0.95 - 0.9
    left = 0.3
    joinery = [
        *(rounded_box([0.24, 2.75, 0.2], 0.03, 1).at(x, 1.375, 0.08) for x in (0.15, width - 0.15)),
        rounded_box([width, 0.5, 0.24], 0.04, 1).at(width / 2, 2.72, 0.1),
        rounded_box([glass + 0.1, 0.55, 0.16], 0.03, 1).at(left + glass / 2, 0.3, 0.06),
        *(box([0.06, 1.85, 0.12]).at(left + glass * k / 3, 1.5, 0.08) for k in range(4)),
        box([glass, 0.05, 0.1]).at(left + glass / 2, 1.98, 0.08),
        rounded_box([door, 2.3, 0.1], 0.02, 1).at(width - 0.3 - door / 2, 1.2, 0.04),
        *(rounded_box([door * 0.62, 0.5, 0.06], 0.03, 1).at(width - 0.3 - door / 2, y, 0.09) for y in (0.55, 1.15)),
    ]
    panes = [_pane(k, glass / 3 - 0.06, 1.85).at(left + glass * (k + 0.5) / 3, 1.5, 0.05) for k in range(3)]
    fanlight = plate(door * 0.6, 0.5).at(width - 0.3 - door / 2, 1.82, 0.1)
    glazing = "ShopWindow" if house.shop else "WindowDark"
    knob = rounded_box([0.05, 0.05, 0.08], 0.024, 2).at(width - 0.3 - door * 0.88, 1.1, 0.12)
    return {"ShopGreen": merge(joinery), glazing: merge([*panes, fanlight]), "Brass": knob}


def house_front(house: House) -> dict[str, Mesh]:
    """A house front without its upper windows, by look."""
    width, height = house.width_m, house.height_m
    courses = [
        rounded_box([width, 0.13, 0.14], 0.03, 1).at(width / 2, SHOP_HEIGHT_M + k * STOREY_M + 0.06, 0.05)
        for k in range(house.storeys)
    ]
    quoins = [
        box([0.34 if k % 2 else 0.24, 0.34, 0.08]).at(x, SHOP_HEIGHT_M + 0.3 + 0.37 * k, 0.03)
        for k in range(int((height - SHOP_HEIGHT_M - 0.7) / 0.37))
        for x in (0.16, width - 0.16)
    ]
    roof = surface(lambda u, v: np.stack([u * width, height + 1.4 * v, -2.0 * v], axis=-1), 2, 2)
    parts = _shop_front(house)
    parts[house.wall] = rounded_box([width, height, 0.3], 0.01, 1).at(width / 2, height / 2, -0.15)
    parts["Trim"] = merge([*courses, *quoins, _cornice(width, height)])
    parts["Roof"] = merge([roof, box([0.5, 1.3, 0.5]).at(width * 0.7, height + 1.0, -1.0)])
    if house.awning:
        parts[house.awning] = _scalloped_awning(width - 0.2).at(0.1, 2.45, 0.2)
        stays = [tube([[x, 2.95, 0.2], [x, 2.46, 1.24]], 0.012, 6) for x in (0.12, width - 0.12)]
        parts["Iron"] = merge([*stays, tube([[0.1, 2.45, 1.25], [width - 0.1, 2.45, 1.25]], 0.014, 6)])
    return parts


def window(pane: str) -> dict[str, Mesh]:
    """A sash window with shutters, its foot in the middle of the origin, facing +Z, by look."""
    width, height = WINDOW_M
    frame = [
        *(box([0.11, height + 0.1, 0.14]).at(x, height / 2, 0.05) for x in (-width / 2, width / 2)),
        rounded_box([width + 0.3, 0.16, 0.2], 0.03, 1).at(0, height + 0.06, 0.07),
        rounded_box([width + 0.34, 0.09, 0.28], 0.02, 1).at(0, -0.03, 0.1),
        box([0.05, height, 0.06]).at(0, height / 2, 0.04),
        *(box([width, 0.04, 0.06]).at(0, height * f, 0.04) for f in (0.34, 0.67)),
    ]
    shutters = []
    for side in (-1, 1):
        x = side * (width / 2 + 0.31)
        shutters += [box([0.05, height, 0.05]).at(x + d, height / 2, 0.05) for d in (-0.2, 0.2)]
        shutters += [box([0.4, 0.1, 0.02]).rotate(x=-28).at(x, 0.1 + 0.185 * k, 0.05) for k in range(8)]
    return {
        "Trim": merge(frame),
        "ShopGreen": merge(shutters),
        pane: plate(width - 0.08, height).at(0, height / 2, 0.03),
    }
