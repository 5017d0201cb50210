"""Stereo cameras of a stage: which camera is whose eye (UsdGeomCamera's ``stereoRole``), and which two are a pair."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from pxr import Sdf, Usd, UsdGeom

Eye = Literal["left", "right"]
EYES: tuple[Eye, Eye] = ("left", "right")
ROLES = ("mono", *EYES)


@dataclass(frozen=True)
class StereoPair:
    """Cameras of two eyes.

    Attributes:
        left: prim path of the left eye's camera.
        right: prim path of the right eye's.
    """

    left: str
    right: str

    def of(self, eye: Eye) -> str:
        """Prim path of an eye's camera."""
        return self.left if eye == "left" else self.right


def stereo_role(prim: Usd.Prim) -> str:
    """Role of a camera: ``mono``, ``left`` or ``right``, or whatever else is authored."""
    return str(UsdGeom.Camera(prim).GetStereoRoleAttr().Get())


def list_pairs(stage: Usd.Stage, cameras: Sequence[str]) -> list[StereoPair]:
    """Pairs of a stage: a left and a right camera below a prim that has no other of either role below it.

    Args:
        stage: the stage.
        cameras: prim paths of its cameras.
    """
    eyes: tuple[list[Sdf.Path], ...] = ([], [])
    below: tuple[defaultdict[Sdf.Path, list[Sdf.Path]], ...] = (defaultdict(list), defaultdict(list))
    for path in map(Sdf.Path, cameras):
        role = stereo_role(stage.GetPrimAtPath(path))
        for eye, found, at in zip(EYES, eyes, below, strict=True):
            if role == eye:
                found.append(path)
                for above in path.GetAncestorsRange():
                    at[above].append(path)
    pairs = []
    for left in eyes[0]:
        parents = [*left.GetParentPath().GetAncestorsRange(), Sdf.Path.absoluteRootPath]
        shared = next((above for above in parents if below[1].get(above)), None)
        if shared is not None and len(below[0][shared]) == len(below[1][shared]) == 1:
            pairs.append(StereoPair(str(left), str(below[1][shared][0])))
    return pairs


def pair_of(pairs: Sequence[StereoPair], camera: str) -> StereoPair | None:
    """The pair that a camera is part of, or the one that stands below the same prim; None where there is no one such pair.

    Args:
        pairs: pairs of the stage.
        camera: prim path.
    """
    own = [pair for pair in pairs if camera in (pair.left, pair.right)]
    near = own or [pair for pair in pairs if all(_is_beside(camera, pair.of(eye)) for eye in EYES)]
    return near[0] if len(near) == 1 else None


def _is_beside(camera: str, other: str) -> bool:
    """Whether a camera stands below the same prim as another; all of a stage is no such prim, but for what is at its top."""
    above = Sdf.Path(camera).GetParentPath()
    return Sdf.Path(other).HasPrefix(above) and (not above.IsAbsoluteRootPath() or other.count("/") == 1)
