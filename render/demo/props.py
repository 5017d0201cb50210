"""Street furniture: lamp post, café table and chair, market stall, planter, paper lantern.

Each prop stands on the origin and faces +Z; it comes as meshes by look.
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, box, disk, hoop, lathe, ring, rounded_box, smooth_curve, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge

STALL_SIZE_M = (2.3, 1.0)


def _circle(radius: float, count: int, height: float = 0.0) -> Array:
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([radius * np.sin(angle), np.full(count, height), radius * np.cos(angle)], axis=1)


def lamp_post() -> dict[str, Mesh]:
    """A cast-iron gas lamp, 3.4 m tall."""
    pole = lathe(
        [[0.17, 0.0], [0.17, 0.10], [0.13, 0.14], [0.12, 0.42], [0.15, 0.46], [0.15, 0.50], [0.075, 0.56], [0.065, 0.75],
         [0.052, 1.6], [0.045, 2.45], [0.075, 2.49], [0.075, 2.53], [0.035, 2.58], [0.03, 2.70], [0.09, 2.74], [0.0, 2.76]],
        20,
    )  # fmt: skip
    flutes = [
        tube(_circle(0.066, 10)[k] + np.array([[0, 0.76, 0], [0, 1.6, 0], [0, 2.4, 0]]), [0.014, 0.011, 0.008], 5)
        for k in range(10)
    ]
    rung = tube([[-0.3, 2.36, 0], [0.3, 2.36, 0]], 0.014, 8)
    cage = [
        tube([foot, top], 0.010, 5) for foot, top in zip(_circle(0.10, 6, 2.76), _circle(0.17, 6, 3.16), strict=True)
    ]
    cap = lathe(
        [
            [0.20, 3.15],
            [0.21, 3.17],
            [0.15, 3.25],
            [0.06, 3.31],
            [0.05, 3.35],
            [0.075, 3.37],
            [0.02, 3.41],
            [0.0, 3.47],
        ],
        18,
    )
    glass = lathe([[0.0, 2.77], [0.085, 2.77], [0.15, 3.14], [0.0, 3.15]], 18)
    knobs = [ball(0.028, 10, 6).at(x, 2.36, 0) for x in (-0.31, 0.31)]
    return {"Iron": merge([pole, *flutes, rung, *cage, cap, *knobs]), "LampGlow": glass}


def cafe_table() -> dict[str, Mesh]:
    """A bistro table with a cloth, a candle in a glass and two cups."""
    stem = lathe(
        [[0.24, 0.0], [0.24, 0.015], [0.06, 0.06], [0.03, 0.12], [0.028, 0.66], [0.07, 0.70], [0.0, 0.705]], 24
    )

    def cloth_shape(u: Array, v: Array) -> Array:
        # v from the hem up over the edge to the middle of the table.
        angle = 2 * np.pi * u
        drape = np.clip((0.35 - v) / 0.35, 0, 1)
        radius = np.where(v > 0.35, 0.365 * (1 - (v - 0.35) / 0.65), 0.37 + 0.03 * drape)
        radius = radius + 0.028 * drape * np.sin(9 * angle)
        y = 0.735 - 0.20 * drape - 0.012 * np.clip(drape * 6, 0, 1)
        return np.stack([radius * np.sin(angle), y, radius * np.cos(angle)], axis=-1)

    candle = lathe([[0.0, 0.735], [0.032, 0.735], [0.037, 0.80], [0.037, 0.82], [0.0, 0.822]], 14)
    flame = lathe([[0.0, 0.815], [0.010, 0.825], [0.012, 0.84], [0.0, 0.875]], 10)
    cup_profile = [[0.0, 0.742], [0.022, 0.744], [0.036, 0.775], [0.042, 0.80], [0.039, 0.80], [0.0, 0.76]]
    cups = [lathe(cup_profile, 18).at(x, 0, z) for x, z in ((0.17, 0.1), (-0.15, -0.12))]
    saucers = [
        lathe([[0.0, 0.736], [0.03, 0.736], [0.068, 0.748], [0.0, 0.742]], 18).at(x, 0, z)
        for x, z in ((0.17, 0.1), (-0.15, -0.12))
    ]
    return {
        "Iron": stem,
        "Cloth": surface(cloth_shape, 73, 24),
        "FlameGlow": candle,
        "BulbAmber": flame,
        "Porcelain": merge([*cups, *saucers]),
    }


def bentwood_chair() -> dict[str, Mesh]:
    """A café chair of bent tubes."""
    back = smooth_curve(
        [[-0.19, 0.0, -0.20], [-0.18, 0.45, -0.18], [-0.19, 0.75, -0.24], [0, 0.93, -0.28], [0.19, 0.75, -0.24],
         [0.18, 0.45, -0.18], [0.19, 0.0, -0.20]], 40
    )  # fmt: skip
    inner = smooth_curve(
        [[-0.10, 0.46, -0.19], [-0.11, 0.68, -0.235], [0, 0.80, -0.26], [0.11, 0.68, -0.235], [0.10, 0.46, -0.19]], 24
    )
    legs = [smooth_curve([[0.9 * x, 0.45, 0.15], [x, 0.22, 0.18], [1.06 * x, 0.0, 0.21]], 8) for x in (-0.17, 0.17)]
    seat = lathe([[0.0, 0.44], [0.205, 0.445], [0.215, 0.46], [0.20, 0.474], [0.0, 0.47]], 28)
    brace = hoop(_circle(0.165, 28, 0.24), 0.008, 6)
    frame = [tube(back, 0.014, 8), tube(inner, 0.010, 6), *(tube(leg, 0.014, 8) for leg in legs), brace]
    return {"Wood": merge([*frame, seat])}


def paper_lantern() -> dict[str, Mesh]:
    """A ribbed paper lantern; it hangs from the origin."""
    rows = np.linspace(0, 1, 49)
    belly = 0.15 * np.sin(np.pi * (0.12 + 0.76 * rows)) ** 0.8 + 0.006 * np.abs(np.sin(rows * np.pi * 12))
    paper = lathe(np.c_[belly, -0.50 + 0.36 * rows], 24)
    caps = [
        lathe([[0.0, y], [0.062, y], [0.066, y + 0.012], [0.062, y + 0.024], [0.0, y + 0.024]], 16)
        for y in (-0.512, -0.155)
    ]
    cord = tube([[0.0, -0.14, 0.0], [0.0, 0.0, 0.0]], 0.004, 5)
    tassel = lathe([[0.0, -0.66], [0.016, -0.65], [0.010, -0.56], [0.012, -0.53], [0.0, -0.51]], 10)
    return {"PaperGlow": paper, "Rubber": merge([*caps, cord]), "Scarf": tassel}


def _crate(x: float) -> Mesh:
    """A slatted crate, tipped towards the customer."""
    slats = [box([0.62, 0.05, 0.015]).at(0, 0.03 + 0.065 * k, z) for k in range(3) for z in (-0.2, 0.2)]
    ends = [box([0.015, 0.18, 0.4]).at(side * 0.31, 0.09, 0) for side in (-1, 1)]
    return merge([*slats, *ends, box([0.62, 0.012, 0.4])]).rotate(x=22).at(x, 0.98, 0.22)


def market_stall() -> dict[str, Mesh]:
    """A market stall with a striped roof and three crates, without the fruit."""
    width, depth = STALL_SIZE_M
    posts = [
        tube([[x, 0, z], [x, 2.3 - 0.25 * (z > 0), z]], 0.03, 10)
        for x in (-width / 2, width / 2)
        for z in (-depth / 2, depth / 2)
    ]
    boards = [box([width, 0.13, 0.03]).at(0, 0.1 + 0.145 * k, -depth / 2) for k in range(6)]
    top = rounded_box([width + 0.1, 0.05, depth + 0.1], 0.02, 2).at(0, 0.93, 0)

    def roof(u: Array, v: Array) -> Array:
        skirt = np.clip(1 - v / 0.2, 0, 1)
        run = np.clip((v - 0.2) / 0.8, 0, 1)
        sag = 0.05 * np.sin(np.pi * run) * (0.6 + 0.4 * np.cos(6 * np.pi * u))
        scallop = 0.16 + 0.06 * np.abs(np.sin(u * np.pi * 11))
        y = 2.1 + 0.42 * np.sqrt(run) - sag - skirt * scallop
        return np.stack([(u - 0.5) * (width + 0.3), y, (depth / 2 + 0.28) - run * (depth + 0.4)], axis=-1)

    def skirt(u: Array, v: Array) -> Array:
        fold = 0.022 * np.sin(u * 2 * np.pi * 17) * (1 - 0.8 * v)
        return np.stack([(u - 0.5) * (width + 0.08), 0.04 + 0.88 * v, depth / 2 + 0.05 + fold], axis=-1)

    cloths = merge([surface(roof, 89, 20), surface(skirt, 137, 6)])
    striped = Mesh(cloths.points, cloths.normals, cloths.points[:, [0, 1]], cloths.quads, cloths.triangles)
    return {"Wood": merge([*posts, *boards, top, *(_crate(x) for x in (-0.72, 0, 0.72))]), "AwningRed": striped}


def fruit_places(seed: int = 5) -> Array:
    """``(n, 3)`` metres in the stall's space: fruit heaped in its three crates."""
    random = np.random.default_rng(seed)
    places = []
    for crate in (-0.72, 0.0, 0.72):
        for layer, (columns, rows) in enumerate(((7, 5), (6, 4), (5, 3))):
            x, z = np.meshgrid(
                (np.arange(columns) - (columns - 1) / 2) * 0.084, (np.arange(rows) - (rows - 1) / 2) * 0.08
            )
            heap = np.stack([x.ravel(), np.full(x.size, 0.07 + 0.062 * layer), z.ravel()], axis=1)
            heap += random.uniform(-0.008, 0.008, heap.shape)
            tip = np.radians(22)
            turned = heap @ np.array([[1, 0, 0], [0, np.cos(tip), np.sin(tip)], [0, -np.sin(tip), np.cos(tip)]])
            places.append(turned + np.array([crate, 0.98, 0.22]))
    return np.concatenate(places)


def fruit(look: str) -> dict[str, Mesh]:
    """One apple or orange, 8 cm across."""
    profile = [
        [0.0, -0.030],
        [0.012, -0.036],
        [0.030, -0.026],
        [0.041, 0.0],
        [0.036, 0.022],
        [0.018, 0.034],
        [0.0, 0.026],
    ]
    return {look: lathe(smooth_curve(profile, 8), 10)}


def planter() -> dict[str, Mesh]:
    """A terracotta pot with a clipped ball tree."""
    pot = lathe(
        [[0.0, 0.0], [0.15, 0.0], [0.21, 0.34], [0.235, 0.35], [0.235, 0.41], [0.20, 0.41], [0.19, 0.36], [0.0, 0.36]],
        24,
    )
    trunk = tube(smooth_curve([[0, 0.34, 0], [0.02, 0.6, 0.01], [0, 0.95, 0]], 8), [0.03] * 4 + [0.02] * 4, 8)
    return {"Clay": pot, "Wood": trunk, "Brass": ring(0.222, 0.008, 24, 6).at(0, 0.30, 0)}


def manhole() -> dict[str, Mesh]:
    """A cast-iron cover with raised rings."""
    rings = [ring(r, 0.008, 36, 6) for r in (0.10, 0.18, 0.26, 0.31)]
    return {"Iron": merge([disk(0.33, 36).at(0, 0.004, 0), *(r.at(0, 0.004, 0) for r in rings)])}
