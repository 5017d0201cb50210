"""RenderPass prim: a source of render settings, and collections of what is drawn and how (UsdRenderPass)."""

from __future__ import annotations

from pxr import Sdf, Usd, UsdRender

from render.errors import SettingsError
from render.model.scene import CameraRole
from render.stage.findings import Finding
from render.stage.render_settings import choose_settings


class RenderPass:
    """Collections of a RenderPass prim that choose what is drawn, and what the camera makes of it.

    Args:
        prim: the prim; see `find_pass`.
    """

    def __init__(self, prim: Usd.Prim) -> None:
        self._prim = prim
        self._visible = Usd.CollectionAPI(prim, "renderVisibility").ComputeMembershipQuery()
        self._pruned = Usd.CollectionAPI(prim, "prune").ComputeMembershipQuery()
        self._camera_visible = Usd.CollectionAPI(prim, "cameraVisibility").ComputeMembershipQuery()
        self._matte = Usd.CollectionAPI(prim, "matte").ComputeMembershipQuery()

    def prunes(self, path: Sdf.Path) -> bool:
        """Whether a prim is left out with all below it."""
        return bool(self._pruned.IsPathIncluded(path))

    def shows(self, path: Sdf.Path) -> bool:
        """Whether a surface or a light is there at all; what lies below it is asked for itself."""
        return bool(self._visible.IsPathIncluded(path))

    def camera_role(self, path: Sdf.Path) -> CameraRole:
        """Role for the camera of a surface that is there, or of the dome behind all surfaces."""
        if not self._camera_visible.IsPathIncluded(path):
            return "unseen"
        return "holdout" if self._matte.IsPathIncluded(path) else "seen"


_COLLECTIONS = ("renderVisibility", "prune", "cameraVisibility", "matte")


def find_missing_targets(stage: Usd.Stage, path: str) -> list[Finding]:
    """Findings on prims that a pass's collections name and the stage does not have.

    Args:
        stage: the stage.
        path: of the pass.
    """
    findings = []
    for name in _COLLECTIONS:
        collection = Usd.CollectionAPI(stage.GetPrimAtPath(path), name)
        for relationship in (collection.GetIncludesRel(), collection.GetExcludesRel()):
            lost = [
                target
                for target in relationship.GetTargets()
                if target.IsPrimPath() and not stage.GetPrimAtPath(target)
            ]
            if lost:
                message = f"{relationship.GetName()} of {path} names {lost[0]}, which the stage does not have"
                findings.append(Finding("missing_target", path, message))
    return findings


def find_pass(stage: Usd.Stage, path: str) -> RenderPass:
    """Find a RenderPass prim, and choose the settings prim that is its source.

    Args:
        stage: the stage.
        path: of the pass.

    Raises:
        SettingsError: there is no such prim, or it has no RenderSettings prim for a source.
    """
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    if not prim or not prim.IsA(UsdRender.Pass):
        known = ", ".join(str(found.GetPath()) for found in stage.Traverse() if found.IsA(UsdRender.Pass))
        raise SettingsError(f"there is no RenderPass prim at {path!r}; the stage has: {known or 'none'}")
    sources = UsdRender.Pass(prim).GetRenderSourceRel().GetForwardedTargets()
    if not sources:
        raise SettingsError(f"render pass {path} has no renderSource, which names its RenderSettings prim")
    choose_settings(stage, str(sources[0]))
    return RenderPass(prim)
