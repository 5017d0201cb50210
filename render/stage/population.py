"""Prims of a stage that are composed: those of a population mask with all that they refer to, and payloads or none."""

from __future__ import annotations

from dataclasses import dataclass

from pxr import Ar, Sdf, Usd

from render.stage.camera_list import list_cameras
from render.stage.findings import FindingLog
from render.stage.render_settings import RenderSettings, settings_at, stage_settings


@dataclass(frozen=True)
class Population:
    """Prims of a stage that are composed.

    Attributes:
        mask: what lies at, below or above these prim paths, and what that refers to; None for everything.
        camera: prim path of the camera that a mask keeps in any case; None keeps those that may be the default one.
        all_cameras: a mask keeps all cameras that are not in payloads.
        settings_prim: path of the RenderSettings prim that a mask keeps, in place of the one that the stage names.
        render_pass: path of a RenderPass prim that a mask keeps.
        unloaded: payloads are not loaded.
    """

    mask: tuple[str, ...] | None = None
    camera: str | None = None
    all_cameras: bool = False
    settings_prim: str | None = None
    render_pass: str | None = None
    unloaded: bool = False


EVERYTHING = Population()


def compose(root: Sdf.Layer, session: Sdf.Layer, context: Ar.ResolverContext, population: Population) -> Usd.Stage:
    """Compose a stage.

    A mask reaches the prims that its prims refer to: materials, prototypes, skeletons. It reaches the render settings with their
    cameras, and where neither these nor the caller name a camera, all cameras that are not in payloads.

    Args:
        root: layer of the stage.
        session: layer over it.
        context: finds its files.
        population: prims that are composed.
    """
    load = Usd.Stage.LoadNone if population.unloaded else Usd.Stage.LoadAll
    if population.mask is None:
        return Usd.Stage.Open(root, session, context, load)
    stage = Usd.Stage.OpenMasked(root, session, context, Usd.StagePopulationMask(list(population.mask)), load)
    settings = population.settings_prim or stage.GetMetadata("renderSettingsPrimPath")
    _reach(stage, [path for path in (population.camera, settings, population.render_pass) if path])
    if population.all_cameras or (population.camera is None and not _names_a_camera(stage, population)):
        _reach(stage, list_cameras(Usd.Stage.Open(root, session, context, Usd.Stage.LoadNone)))
    return stage


def note_unloaded(stage: Usd.Stage, log: FindingLog) -> None:
    """Note payloads that were left out."""
    if stage.GetLoadRules() == Usd.StageLoadRules.LoadAll():
        return
    loaded = set(stage.GetLoadSet())
    left_out = [path for path in stage.FindLoadable() if path not in loaded]
    if left_out:
        count = f"{len(left_out):,} payloads are" if len(left_out) > 1 else "a payload is"
        message = f"{count} not loaded, at {left_out[0]}{' and elsewhere' if len(left_out) > 1 else ''}: not drawn"
        log.add("unloaded_payloads", left_out[0], message)


def _reach(stage: Usd.Stage, paths: list[str]) -> None:
    """Add prims to the mask of a stage, with all that its prims refer to."""
    mask = stage.GetPopulationMask()
    for path in paths:
        if Sdf.Path.IsValidPathString(path) and Sdf.Path(path).IsAbsoluteRootOrPrimPath():
            mask.Add(path)
    stage.SetPopulationMask(mask)
    stage.ExpandPopulationMask(_is_needed)


def _is_needed(relationship: Usd.Relationship) -> bool:
    """Whether a prim needs the targets of its relationship: collections are asked by path alone."""
    return not relationship.GetName().startswith("collection:")


def _names_a_camera(stage: Usd.Stage, population: Population) -> bool:
    """Whether the render settings name a camera that exists."""
    if population.render_pass is not None:
        return False
    path = population.settings_prim
    settings: RenderSettings | None = settings_at(stage, path) if path is not None else stage_settings(stage)
    camera = settings.camera_path if settings else None
    return camera is not None and bool(stage.GetPrimAtPath(camera))
