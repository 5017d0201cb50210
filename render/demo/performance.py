"""Performance of the two robots over the 96 frames, as functions of the frame. Metres and degrees.

Pip looks into its lantern; at frame 40 it hears the bell and turns to Mara, who comes up the street on her wheel and
waves. The focus follows its look.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from pxr import Kind, Usd, UsdGeom

from render.demo import mara, pip
from render.demo.author import FRAMES_PER_SECOND, animate, stand, write_part

CAST = "/World/Cast"
PIP, MARA = f"{CAST}/Pip", f"{CAST}/Mara"
PIP_PLACE_M = (-0.47, 0.0, -2.55)
PIP_YAW = 14.0


def seconds(frame: float) -> float:
    """Time since frame 1."""
    return (frame - 1) / FRAMES_PER_SECOND


def ease(frame: float, start: float, end: float) -> float:
    """0 before ``start``, 1 after ``end``, with no jerk between (Perlin's quintic)."""
    t = min(max((frame - start) / (end - start), 0.0), 1.0)
    return t * t * t * (t * (6 * t - 15) + 10)


def _wave(frame: float, period_s: float, phase: float = 0.0) -> float:
    return float(np.sin(2 * np.pi * seconds(frame) / period_s + phase))


def pip_head(frame: float) -> list[float]:
    """Down into the lantern light, then up and round to Mara."""
    turn = ease(frame, 38, 54)
    settle = 5 * np.exp(-max(frame - 50, 0) / 7) * np.sin(max(frame - 50, 0) / 3.2)
    return [6 - 10 * turn + 1.2 * _wave(frame, 2.6), 14 + 52 * turn + settle, -5 + 9 * turn + _wave(frame, 3.1)]


def pip_blink(frame: float) -> list[float]:
    """Shuts the eyes for a moment three times."""
    shut = max(np.exp(-(((frame - at) / 1.3) ** 2)) for at in (16, 41, 72))
    return [1.0, 1.0 - 0.9 * shut, 1.0]


def pip_body(frame: float) -> list[float]:
    """Sways, breathes, and turns a little after its head."""
    return [0.8 * _wave(frame, 2.6), 15 * ease(frame, 42, 62), 0.9 * _wave(frame, 3.7)]


def pip_lantern(frame: float) -> list[float]:
    """Swings on its hook, harder after the turn."""
    kick = 7 * np.exp(-max(frame - 46, 0) / 22) * np.sin(max(frame - 46, 0) / 4.2)
    return [2.5 * _wave(frame, 1.6), 0.0, 3.0 * _wave(frame, 1.45, 0.6) + kick]


def mara_place(frame: float) -> list[float]:
    """Rolls up the street and comes to a stop near the end of the shot."""
    gone = 0.62 * ease(frame, -30, 104) + 0.38 * ease(frame, 1, 92)
    return [1.62 - 0.78 * gone, 0.012 * abs(_wave(frame, 0.8)), -9.3 + 1.35 * gone]


def mara_wave(frame: float) -> list[float]:
    """Lifts the free arm and waves."""
    lift = ease(frame, 44, 60)
    return [0.0, 0.0, 38 - 52 * lift + 15 * lift * _wave(frame, 0.75)]


MOTIONS: dict[str, dict[str, Callable[[float], list[float]]]] = {
    f"{PIP}/Body": {"rotate": pip_body},
    f"{PIP}/Body/Head": {"rotate": pip_head},
    f"{PIP}/Body/Head/Eyes": {"scale": pip_blink},
    f"{PIP}/Body/ArmRight/Lantern": {"rotate": pip_lantern},
    f"{PIP}/Body/ArmLeft": {"rotate": lambda frame: [3 * _wave(frame, 2.6), 0.0, 2 * _wave(frame, 3.1)]},
    f"{MARA}/Body": {"rotate": lambda frame: [2.0, 3 * _wave(frame, 2.4), 2.2 * _wave(frame, 1.6)]},
    f"{MARA}/Body/Head": {"rotate": lambda frame: [3.0, -10 + 4 * _wave(frame, 2.9), 5 * _wave(frame, 2.2)]},
    f"{MARA}/Body/ArmWave": {"rotate": mara_wave},
    f"{MARA}/Body/Umbrella": {"rotate": lambda frame: [2 * _wave(frame, 2.0), 0.0, 2.5 * _wave(frame, 2.3)]},
    f"{MARA}/Wheel": {"rotate": lambda frame: [np.degrees((mara_place(frame)[2] + 9.3) / 0.17), 0.0, 0.0]},
}


def write_cast(stage: Usd.Stage) -> None:
    """Authors the robots' parts, each an Xform at its joint."""
    Usd.ModelAPI(UsdGeom.Xform.Define(stage, CAST).GetPrim()).SetKind(Kind.Tokens.group)
    for root, parts, joints in ((PIP, pip.parts(), pip.JOINTS), (MARA, mara.parts(), mara.JOINTS)):
        Usd.ModelAPI(UsdGeom.Xform.Define(stage, root).GetPrim()).SetKind(Kind.Tokens.component)
        for name, meshes in parts.items():
            stand(write_part(stage, f"{root}/{name}", meshes, ("Umbrella",)), joints.get(name, (0.0, 0.0, 0.0)))


def write_motion(stage: Usd.Stage) -> None:
    """Author the keys of `MOTIONS` and the robots' positions."""
    stand(stage.GetPrimAtPath(PIP), PIP_PLACE_M, yaw=PIP_YAW)
    animate(stage.GetPrimAtPath(MARA), translate=mara_place, rotate=lambda frame: [0.0, -12.0, 0.0])
    for path, motion in MOTIONS.items():
        animate(stage.GetPrimAtPath(path), rotate=motion.get("rotate"), scale=motion.get("scale"))
