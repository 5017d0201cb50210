"""Mara, the far subject: a tall robot in a yellow raincoat under a red umbrella, on one wheel. She stands on the origin,
2.2 m to the umbrella's tip, facing +Z.
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, lathe, ring, smooth_curve, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge
from render.demo.shells import Pillow, hand

HEAD = Pillow((0.150, 0.185, 0.155), 2.3)
CANOPY_RIBS = 8

JOINTS = {
    "Body": (0.0, 0.20, 0.0),
    "Wheel": (0.0, 0.17, 0.0),
    "Body/Head": (0.0, 1.19, 0.0),
    "Body/ArmWave": (-0.150, 1.05, 0.0),
    "Body/Umbrella": (0.165, 1.05, 0.0),
}


def parts() -> dict[str, dict[str, Mesh]]:
    """Every part's meshes by look; the key is the part's path below the robot."""
    return {
        "Wheel": _wheel(),
        "Body": _body(),
        "Body/Head": _head(),
        "Body/ArmWave": _sleeve([[0, 0, 0], [-0.13, -0.14, 0.02], [-0.25, -0.05, 0.06], [-0.33, 0.12, 0.08]], 165),
        "Body/Umbrella": _umbrella_arm(),
    }


def _wheel() -> dict[str, Mesh]:
    tyre = ring(0.135, 0.035, 48, 14).rotate(z=90)
    hub = lathe([[0.0, -0.05], [0.05, -0.045], [0.10, -0.012], [0.10, 0.012], [0.05, 0.045], [0.0, 0.05]], 28).rotate(
        z=90
    )
    spokes = [ball(0.014, 10, 6).at(0.035, 0.08 * np.cos(a), 0.08 * np.sin(a)) for a in np.arange(6) * np.pi / 3]
    return {"Rubber": tyre, "Brass": merge([hub, *spokes])}


def _body() -> dict[str, Mesh]:
    """A raincoat with deep folds that flares to its hem, its collar and buttons; the origin is above the wheel."""
    profile = smooth_curve(
        [[0.345, -0.06], [0.315, 0.12], [0.235, 0.48], [0.142, 0.80], [0.165, 0.98], [0.150, 1.08], [0.070, 1.145]], 60
    )

    def coat(u: Array, v: Array) -> Array:
        radius, height = (np.interp(v, np.linspace(0, 1, 60), profile[:, k]) for k in range(2))
        fold = np.clip(1 - v / 0.62, 0, 1) ** 1.2
        angle = 2 * np.pi * u
        flutes = np.sin(9 * angle + 1.5 * np.sin(2 * angle)) * 0.085 + 0.04 * np.sin(4 * angle + 2)
        out = radius * (1 + fold * flutes)
        return np.stack([out * np.sin(angle), height + 0.012 * fold * flutes * 8, out * np.cos(angle) * 0.88], axis=-1)

    collar = lathe([[0.075, 1.10], [0.135, 1.16], [0.145, 1.195], [0.130, 1.19], [0.07, 1.13]], 36)
    cape = lathe(smooth_curve([[0.235, 0.90], [0.225, 0.94], [0.185, 1.05], [0.085, 1.145]], 16), 44).scale(1, 1, 0.85)
    belt = ring(0.148, 0.016, 40, 8).at(0, 0.785, 0).scale(1, 1, 0.88)
    buttons = [ball(0.014, 12, 8).at(0, y, z) for y, z in ((0.66, 0.158), (0.54, 0.19), (0.42, 0.222))]
    neck = lathe([[0.045, 1.12], [0.040, 1.23]], 20)
    coat_mesh = surface(coat, 121, 56)
    return {"Raincoat": merge([coat_mesh, collar, cape]), "Brass": merge([belt, *buttons, neck])}


def _head() -> dict[str, Mesh]:
    """A porcelain face with a lit eyes under a rain hat; the origin is the neck."""
    up = 0.18
    hat = lathe(
        smooth_curve(
            [[0.262, 0.045], [0.238, 0.070], [0.178, 0.095], [0.165, 0.145], [0.125, 0.205], [0.0, 0.228]], 28
        ),
        44,
    )
    brim = lathe(smooth_curve([[0.13, 0.08], [0.20, 0.065], [0.262, 0.045]], 10), 44)
    eyes = merge(HEAD.patch(side * 0.36, -0.03, 0.20, 0.20, 1.03) for side in (-1, 1))
    cheeks = [ring(0.034, 0.009, 24, 8).rotate(z=90).at(side * 0.146, -0.02, 0) for side in (-1, 1)]
    shade = HEAD.patch(0, -0.03, 0.86, 0.40, 1.008, 2.8)
    return {
        "Porcelain": HEAD.shell(48, 30).at(0, up, 0),
        "Raincoat": merge([hat, brim]).rotate(x=-6).at(0, up, 0),
        "FacePlate": shade.at(0, up, 0),
        "VisorGlow": eyes.at(0, up, 0),
        "Brass": merge([*cheeks]).at(0, up, 0),
    }


def _sleeve(path: list[list[float]], wrist_turn: float) -> dict[str, Mesh]:
    curve = smooth_curve(path, 26)
    sleeve = tube(curve, np.interp(np.linspace(0, 1, 26), [0, 0.5, 0.9, 1], [0.060, 0.048, 0.058, 0.062]), 18)
    glove = hand(0.25).rotate(x=wrist_turn).at(*(2 * curve[-1] - curve[-4]))
    return {"Raincoat": sleeve, "Porcelain": glove}


def _canopy() -> Mesh:
    """Cloth stretched between the ribs: it dips between them and is scalloped at the hem; crown at the origin."""

    def shape(u: Array, v: Array) -> Array:
        # v from the hem up to the crown.
        angle, reach = 2 * np.pi * u, 1 - np.clip(v, 0, 1)
        between = np.abs(np.sin(CANOPY_RIBS / 2 * angle))
        radius = 0.60 * reach * (1 - 0.075 * between * reach**2)
        y = -0.30 * reach**2 - 0.045 * between * np.sin(np.pi * reach * 0.62) + 0.035 * between * reach**6
        return np.stack([radius * np.sin(angle), y, radius * np.cos(angle)], axis=-1)

    return surface(shape, 8 * 12 + 1, 22)


def _umbrella_arm() -> dict[str, Mesh]:
    """The sleeve that holds the umbrella, and the umbrella; the origin is the shoulder."""
    grip = np.array([0.09, -0.08, 0.20])
    arm = _sleeve([[0, 0, 0], [0.09, -0.17, 0.03], [0.115, -0.17, 0.14], [0.09, -0.10, 0.20]], -70)
    crown = grip + np.array([-0.13, 0.93, -0.12])
    lean = np.degrees([np.arctan2(-0.12, 0.93), np.arctan2(0.13, 0.93)])
    shaft = tube([grip + np.array([0.012, -0.10, 0.011]), crown], 0.008, 10)
    hook = tube(
        smooth_curve(
            [
                grip + np.array([0.012, -0.09, 0.011]),
                grip + np.array([0.02, -0.17, 0.02]),
                grip + np.array([0.05, -0.19, 0.04]),
                grip + np.array([0.06, -0.15, 0.05]),
            ],
            18,
        ),
        0.014,
        10,
    )
    angle = np.arange(CANOPY_RIBS) * 2 * np.pi / CANOPY_RIBS
    reach = np.linspace(0.03, 0.985, 12)
    ribs = [
        tube(
            np.stack([0.60 * reach * np.sin(a), -0.30 * reach**2 - 0.008, 0.60 * reach * np.cos(a)], axis=1), 0.0045, 6
        )
        for a in angle
    ]
    stays = [tube([[0, -0.42, 0], [0.3 * np.sin(a), -0.085, 0.3 * np.cos(a)]], 0.0035, 5) for a in angle]
    tips = [ball(0.011, 10, 6).at(0.6 * np.sin(a), -0.305, 0.6 * np.cos(a)) for a in angle]
    spike = lathe([[0.014, -0.01], [0.012, 0.03], [0.006, 0.09], [0.0, 0.10]], 12)
    metal = merge([*ribs, *stays, *tips, spike]).rotate(x=lean[0], z=lean[1]).at(*crown)
    canopy = _canopy().rotate(x=lean[0], z=lean[1]).at(*crown)
    return {**arm, "Brass": metal, "Wood": merge([hook, shaft]), "Umbrella": canopy}
