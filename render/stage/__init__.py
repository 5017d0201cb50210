"""USD stage to Scene: flat arrays, materials, lights and the camera at one time. The one room that reads pxr and textures."""

from __future__ import annotations

from render.stage.anchors.anchors import AnchorReader, anchor_position
from render.stage.camera.cameras import (
    CameraChoice,
    conform_camera,
    conform_to_stage,
    default_camera,
    read_camera,
)
from render.stage.camera.orthographic import stand_together
from render.stage.camera.plate_list import BackPlate, list_plates
from render.stage.camera.stereo import EYES, Eye, StereoPair, list_pairs, pair_of, stereo_role
from render.stage.camera_list import list_cameras
from render.stage.findings import Finding
from render.stage.honoured.walk import find_not_honoured
from render.stage.opening import open_stage, quiet_diagnostics
from render.stage.options import StageOptions
from render.stage.reader import StageReader
from render.stage.render_pass import find_missing_targets, find_pass
from render.stage.render_settings import RenderSettings, choose_settings, stage_settings
from render.stage.world import FrameRange, frame_range, is_y_up, world_from_stage

__all__ = [
    "EYES",
    "AnchorReader",
    "BackPlate",
    "CameraChoice",
    "Eye",
    "Finding",
    "FrameRange",
    "RenderSettings",
    "StageOptions",
    "StageReader",
    "StereoPair",
    "anchor_position",
    "choose_settings",
    "conform_camera",
    "conform_to_stage",
    "default_camera",
    "find_missing_targets",
    "find_not_honoured",
    "find_pass",
    "frame_range",
    "is_y_up",
    "list_cameras",
    "list_pairs",
    "list_plates",
    "open_stage",
    "pair_of",
    "quiet_diagnostics",
    "read_camera",
    "stage_settings",
    "stand_together",
    "stereo_role",
    "world_from_stage",
]
