"""Pip, the near subject: a small round lamplighter robot with a scarf. It stands on the origin, 1.2 m tall, facing +Z.

Each part is built about its own joint; `JOINTS` has the position of that joint in the parent part's space, m.
"""

from __future__ import annotations

import numpy as np

from render.demo.shapes.kit import ball, hoop, lathe, ring, smooth_curve, surface, tube
from render.demo.shapes.mesh import Array, Mesh, merge
from render.demo.shells import Pillow, hand

HEAD = Pillow((0.232, 0.176, 0.200), 2.7)
EYE_PITCH, EYE_YAW = 0.03, 0.36

JOINTS = {
    "Body": (0.0, 0.26, 0.0),
    "Body/Head": (0.0, 0.56, 0.0),
    "Body/Head/Eyes": (0.0, 0.186, 0.0),
    "Body/ArmLeft": (-0.215, 0.39, 0.0),
    "Body/ArmRight": (0.215, 0.39, 0.0),
    "Body/ArmRight/Lantern": (0.10, 0.245, 0.29),
}


def parts() -> dict[str, dict[str, Mesh]]:
    """Build the meshes of every part, by path below the robot, then by material (`render.demo.looks.TABLE`)."""
    return {
        "Legs": _legs(),
        "Body": _body(),
        "Body/Head": _head(),
        "Body/Head/Eyes": {"EyeGlow": _eyes()},
        "Body/ArmLeft": _arm(
            [[0, 0, 0], [-0.075, -0.09, 0.01], [-0.10, -0.19, 0.05], [-0.085, -0.27, 0.10]], (-8, 0), 0.5
        ),
        "Body/ArmRight": _arm(
            [[0, 0, 0], [0.095, -0.05, 0.06], [0.115, 0.08, 0.17], [0.10, 0.22, 0.22]], (-90, 180), 1.0
        ),
        "Body/ArmRight/Lantern": _lantern(),
    }


def _legs() -> dict[str, Mesh]:
    shins, boots = [], []
    for x in (-0.095, 0.095):
        shins.append(tube([[x, 0.10, 0], [x, 0.30, 0]], 0.045, 16))
        boots.append(Pillow((0.075, 0.06, 0.115), 2.6).shell(32, 18).at(x, 0.06, 0.03))
    return {"Rubber": merge(shins), "EnamelTeal": merge(boots)}


def _body() -> dict[str, Mesh]:
    """Build the egg-shaped body, belt, collar, chest lamp and scarf; the origin is the hip."""
    egg = smooth_curve([[0.10, 0.0], [0.185, 0.05], [0.236, 0.17], [0.226, 0.30], [0.168, 0.43], [0.10, 0.495]], 44)
    shell = lathe(np.concatenate([[[0.0, -0.01]], egg, [[0.0, 0.50]]]), 56)
    # A teal skirt over the lower half, 1.2 % wider than the egg.
    lower = lathe(np.concatenate([egg[:16] * [1.012, 1.0] - [0, 0.004], [egg[16] * [1.0, 1.0]]]), 56)
    rivets = [
        ball(0.011, 10, 6).at(0.2335 * np.sin(a), 0.205, 0.2335 * np.cos(a))
        for a in np.linspace(0, 2 * np.pi, 18, endpoint=False)
    ]
    belt = ring(0.2345, 0.011, 64, 10).at(0, 0.178, 0)
    bezel = ring(0.040, 0.009, 32, 8).rotate(x=78).at(0.0, 0.318, 0.218)
    lamp = lathe([[0.036, 0.0], [0.026, 0.014], [0.0, 0.020]], 24).rotate(x=78).at(0.0, 0.318, 0.216)
    bellows = [ring(0.088, 0.016, 36, 8).at(0, 0.505 + 0.024 * k, 0) for k in range(3)]
    return {
        "EnamelCream": shell,
        "EnamelTeal": lower,
        "Brass": merge([*rivets, belt, bezel]),
        "Rubber": merge(bellows),
        "HeartGlow": lamp,
        "Scarf": _scarf(),
    }


def _scarf() -> Mesh:
    """Build two loose turns about the neck and two tails down the front."""
    angle = np.linspace(0, 2 * np.pi, 56, endpoint=False)
    wraps = []
    for radius, height, phase in ((0.142, 0.468, 0.0), (0.128, 0.512, 1.4)):
        wave = height + 0.014 * np.sin(angle + phase) - 0.018 * np.cos(angle)
        path = np.stack([radius * np.sin(angle), wave, radius * np.cos(angle)], axis=1)
        wraps.append(hoop(path, 0.043, 14))
    knot = Pillow((0.052, 0.046, 0.042), 2.3).shell(24, 14).rotate(z=20).at(-0.075, 0.445, 0.158)
    tails = [_scarf_tail(-0.085, 0.30, -9), _scarf_tail(-0.060, 0.22, 12)]
    return merge([*wraps, knot, *tails])


def _scarf_tail(x: float, length: float, lean: float) -> Mesh:
    """Build a flat knitted strip with a fringe that hangs from the knot over the belly; ``lean`` in degrees."""

    def shape(u: Array, v: Array) -> Array:
        # u runs once around the strip's flat section, v up from the fringe.
        angle = 2 * np.pi * u
        drop = -length * (1 - v)
        swell = 0.066 * np.sin(np.pi * np.clip((v * length + 0.12) / 0.52, 0, 1))
        across = 0.046 * np.sign(np.sin(angle)) * np.abs(np.sin(angle)) ** 0.6
        z = 0.010 * np.cos(angle) + swell - 0.02 + 0.012 * np.sin(9 * v + 14 * across)
        return np.stack([across, drop, z], axis=-1)

    strip = surface(shape, 25, 24)
    strip = Mesh(strip.points, strip.normals, strip.points[:, [0, 1]], strip.quads, strip.triangles)
    foot = float(shape(np.array(0.0), np.array(0.0))[2])
    fringe = [
        tube([[k * 0.011, -length, foot], [k * 0.012, -length - 0.035, foot + 0.004]], 0.0042, 5) for k in range(-4, 5)
    ]
    return merge([strip, *fringe]).rotate(z=lean).at(x, 0.45, 0.172)


def _head() -> dict[str, Mesh]:
    """Build helmet, glass face, ears and antenna; the origin is the neck."""
    up = 0.18
    plate = HEAD.patch(0, 0.02, 0.86, 0.60, 1.012, 3.6)
    bead = HEAD.rim(0.02, 0.87, 0.61, 1.01, 3.6, 0.011)
    crown = tube(smooth_curve([[0, 0.165, -0.10], [0, 0.181, 0.0], [0, 0.165, 0.10]], 16), 0.016, 10)
    ear = lathe(
        [[0.078, 0.0], [0.078, 0.022], [0.066, 0.036], [0.05, 0.036], [0.044, 0.05], [0.018, 0.054], [0.0, 0.054]], 36
    )
    ears = [ear.rotate(z=-90 * side).at(side * 0.224, 0, -0.01) for side in (-1, 1)]
    mast = tube(smooth_curve([[0.11, 0.15, -0.06], [0.125, 0.22, -0.075], [0.118, 0.30, -0.10]], 12), 0.006, 8)
    tip = ball(0.019, 18, 12).at(0.118, 0.312, -0.102)
    smile = np.linspace(-0.16, 0.16, 14)
    mouth = tube(HEAD.project(smile, -0.27 + 1.9 * smile**2, 1.045), 0.0065, 8)
    foot = lathe([[0.022, 0.0], [0.022, 0.012], [0.0, 0.016]], 16).rotate(z=-25).at(0.11, 0.146, -0.06)
    return {
        "EnamelCream": HEAD.shell().at(0, up, 0),
        "FacePlate": plate.at(0, up, 0),
        "EnamelTeal": merge([bead, crown, *ears]).at(0, up, 0),
        "Brass": merge([mast, foot, ring(0.15, 0.012, 40, 8).at(0, -0.168, 0)]).at(0, up, 0),
        "HeartGlow": tip.at(0, up, 0),
        "EyeGlow": mouth.at(0, up, 0),
    }


def _eyes() -> Mesh:
    return merge(HEAD.patch(side * EYE_YAW, EYE_PITCH, 0.165, 0.25, 1.035) for side in (-1, 1))


def _arm(path: list[list[float]], wrist: tuple[float, float], curl: float) -> dict[str, Mesh]:
    """Build a bent sleeve from the shoulder, with a cuff and a hand.

    Args:
        path: ``(n, 3)`` points of the sleeve from the shoulder, m.
        wrist: rotation of the hand about X, then Z, degrees.
        curl: how far the fingers bend: 0 not at all, 1 fully.
    """
    curve = smooth_curve(path, 26)
    sleeve = tube(curve, np.interp(np.linspace(0, 1, 26), [0, 0.5, 1], [0.036, 0.030, 0.034]), 14)
    shoulder = ball(0.062, 28, 18)
    cuff = tube(curve[-8:], np.interp(np.linspace(0, 1, 8), [0, 0.15, 1], [0.036, 0.052, 0.060]), 22)
    fingers = hand(curl).scale(0.85).rotate(x=wrist[0], z=wrist[1]).at(*(2 * curve[-1] - curve[-4]))
    return {"Rubber": sleeve, "EnamelCream": merge([shoulder, fingers]), "EnamelTeal": cuff}


def _lantern() -> dict[str, Mesh]:
    """Build a storm lantern that hangs from the origin."""
    handle = np.linspace(0, np.pi, 20)
    bail = tube(np.stack([0.062 * np.cos(handle), -0.085 + 0.085 * np.sin(handle), 0 * handle], axis=1), 0.005, 8)
    cap = lathe(
        [
            [0.070, -0.115],
            [0.074, -0.110],
            [0.050, -0.085],
            [0.030, -0.078],
            [0.028, -0.066],
            [0.036, -0.062],
            [0.0, -0.05],
        ],
        28,
    )
    base = lathe([[0.0, -0.268], [0.072, -0.268], [0.076, -0.260], [0.070, -0.245], [0.050, -0.238], [0.0, -0.236]], 28)
    glass = lathe(smooth_curve([[0.044, -0.238], [0.056, -0.205], [0.058, -0.165], [0.046, -0.115]], 16), 28)
    bars = [
        tube(np.array([[0.069 * np.sin(a), y, 0.069 * np.cos(a)] for y in (-0.25, -0.18, -0.112)]), 0.004, 6)
        for a in np.arange(4) * np.pi / 2 + np.pi / 4
    ]
    hoops = [ring(0.069, 0.004, 28, 6).at(0, y, 0) for y in (-0.21, -0.15)]
    return {"Brass": merge([bail, cap, base, *bars, *hoops]), "FlameGlow": glass}
