"""Camera that frames a stage without one, as usdrecord does."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from pxr import Sdf, Usd

from render.errors import StageError
from render.model.camera import Camera
from render.stage.geometry.splat_boxes import box_below
from render.stage.instancer_loops import find_instancer_loop
from render.stage.opening import lost_files, read_quietly
from render.stage.options import DRAWN_PURPOSES
from render.stage.world import is_y_up, world_from_stage
from usd_schemas.units import metres_per_unit

# GfCamera's own defaults.
_FOCAL_LENGTH_MM, _APERTURE_MM = 50.0, (20.955, 15.2908)
_NEAR, _FAR = 1.0, 1e6  # scene units, whatever the unit is


def framing_camera(
    stage: Usd.Stage, time: float, *, purposes: Sequence[str] = DRAWN_PURPOSES, mask: Sequence[str] | None = None
) -> Camera:
    """Make a pinhole camera in front of the whole stage, placed as by ``UsdAppUtilsFrameRecorder`` (OpenUSD).

    It looks at the centre of the stage's box, from where the half diagonal of the box's front fills half of the horizontal field
    of view; by a scene unit more where that is nearer than its near clipping distance, which is 1 scene unit.

    Args:
        stage: the stage.
        time: USD time code of the box.
        purposes: which of default, render, proxy and guide are in the box.
        mask: prim paths of a population mask; None for the whole stage.

    Raises:
        StageError: there is nothing to frame; code ``empty_stage``.
    """
    with read_quietly(stage):
        if mask is not None:
            population = Usd.StagePopulationMask([Sdf.Path(path) for path in mask])
            unloaded = stage.GetLoadRules() != Usd.StageLoadRules.LoadAll()
            layers = stage.GetRootLayer(), stage.GetSessionLayer(), stage.GetPathResolverContext()
            stage = Usd.Stage.OpenMasked(*layers, population, Usd.Stage.LoadNone if unloaded else Usd.Stage.LoadAll)
        loop = find_instancer_loop(stage)
        if loop is not None:
            message = f"instancer {loop} is among its own prototypes: the stage has no end that a camera could frame"
            raise StageError(message, code="empty_stage", path=str(loop))
        box = box_below(stage.GetPseudoRoot(), Usd.TimeCode(time), purposes)
    if box.IsEmpty() or not np.isfinite([*box.GetMin(), *box.GetMax()]).all():
        name = stage.GetRootLayer().GetDisplayName()
        why = "".join(f"; {lost.message}" for lost in lost_files(stage)[:1])
        if mask is not None:
            raise StageError(
                f"the mask {', '.join(mask)} leaves nothing of {name} that a camera could frame: name a camera, or mask what is "
                f"to be drawn{why}",
                code="empty_stage",
            )
        raise StageError(f"{name} has no camera, and nothing that a camera could frame{why}", code="empty_stage")
    size, (up, depth) = box.GetSize(), (1, 2) if is_y_up(stage) else (2, 1)
    half_view = _APERTURE_MM[0] / 2 / _FOCAL_LENGTH_MM
    distance = math.hypot(size[0], size[up]) / 2 / half_view + size[depth] / 2
    if distance < _NEAR:
        distance += _NEAR
    scale = metres_per_unit(stage)
    pose = np.eye(4)
    pose[:, 3] = world_from_stage(stage) @ [*box.GetMidpoint(), 1.0]
    pose[2, 3] += distance * scale
    return Camera(
        pose,
        _FOCAL_LENGTH_MM,
        *_APERTURE_MM,
        focus_distance_m=distance * scale,
        near_m=_NEAR * scale,
        far_m=_FAR * scale,
    )
