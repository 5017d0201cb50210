"""RenderSettings prim that a stage is rendered by: the one that the caller chose, else the one that the stage names."""

from __future__ import annotations

from dataclasses import dataclass

from pxr import Gf, Sdf, Usd, UsdRender, Vt

from render.colour import is_working_space
from render.errors import InputError, SettingsError
from render.stage.findings import FindingLog
from render.stage.options import PURPOSES
from render.stage.values import format_value

_FRAMING_PROPERTIES = ("dataWindowNDC", "pixelAspectRatio", "disableDepthOfField")
_MOTION_PROPERTIES = ("disableMotionBlur", "instantaneousShutter")
_STAGE_FIELD = UsdRender.Tokens.renderSettingsPrimPath


@dataclass(frozen=True, eq=False)
class RenderSettings:
    """Values of a RenderSettings prim. A value of another type than its schema's counts as none.

    Attributes:
        prim: the prim.
    """

    prim: UsdRender.Settings

    @property
    def path(self) -> str:
        """Prim path."""
        return str(self.prim.GetPath())

    @property
    def camera_path(self) -> str | None:
        """Path of the camera; None where it names none."""
        targets = self.prim.GetCameraRel().GetForwardedTargets()
        return str(targets[0]) if targets else None

    @property
    def conform_policy(self) -> str:
        """Policy by which the camera's gate becomes the picture's shape, as it is authored."""
        return str(self.prim.GetAspectRatioConformPolicyAttr().Get())

    @property
    def resolution(self) -> tuple[int, int] | None:
        """Width and height in pixels; None where they are not authored."""
        attribute = self.prim.GetResolutionAttr()
        value = attribute.Get() if attribute.HasAuthoredValue() else None
        return (value[0], value[1]) if isinstance(value, Gf.Vec2i) else None

    @property
    def included_purposes(self) -> tuple[str, ...] | None:
        """Purposes that are drawn, the default one always among them; None where the value is no list of tokens."""
        value = self.prim.GetIncludedPurposesAttr().Get()
        if not isinstance(value, Vt.TokenArray):
            return None
        return tuple(dict.fromkeys(("default", *(str(word) for word in value if str(word) in PURPOSES))))

    def binding_purposes(self, log: FindingLog) -> tuple[str, ...] | None:
        """Purposes of material bindings in the order in which they are tried; None where none are authored.

        Args:
            log: notes a value of another type.
        """
        attribute = self.prim.GetMaterialBindingPurposesAttr()
        if not attribute.HasAuthoredValue():
            return None
        value = attribute.Get()
        if not isinstance(value, Vt.TokenArray | None):
            message = (
                f"materialBindingPurposes of {self.path} must be a list of tokens, got {format_value(value)}: not used"
            )
            log.add("bad_binding_purposes", self.path, message)
            return None
        return tuple(str(purpose) for purpose in value or ()) or None

    def rendering_space(self, log: FindingLog) -> str:
        """Linear colour space that EXR files are written in: ``renderingColorSpace``. Empty for the working space.

        Args:
            log: notes a space that is not used, or not the one that light is added in.
        """
        attribute = self.prim.GetRenderingColorSpaceAttr()
        space = str(attribute.Get() or "") if attribute.HasAuthoredValue() else ""
        if not space:
            return ""
        try:
            if is_working_space(space):
                return ""
        except InputError as problem:
            message = f"renderingColorSpace of {self.path} is not used: {problem}"
            log.add("bad_rendering_space", self.path, message)
            return ""
        message = (
            f"renderingColorSpace {space} of {self.path} is not the scene_linear space of OpenColorIO's configuration: light is "
            "added in that space, and colours are converted when an EXR is written"
        )
        log.add("rendering_space", self.path, message)
        return space

    def only_for_products(self, *, has_motion: bool) -> list[str]:
        """Names of authored properties that only products obey, and that ask for more than their fallbacks.

        Args:
            has_motion: whether the picture may show motion.
        """
        prim = self.prim.GetPrim()
        names = _FRAMING_PROPERTIES + (_MOTION_PROPERTIES if has_motion else ())
        attributes = [prim.GetAttribute(name) for name in names]
        fallbacks = prim.GetPrimDefinition().GetAttributeFallbackValue
        return [
            attribute.GetName()
            for attribute in attributes
            if attribute.HasAuthoredValue() and attribute.Get() != fallbacks(attribute.GetName())
        ]


def stage_settings(stage: Usd.Stage) -> RenderSettings | None:
    """Settings that a stage is rendered by; None where there are none."""
    settings = UsdRender.Settings.GetStageRenderSettings(stage)
    return RenderSettings(settings) if settings else None


def settings_at(stage: Usd.Stage, path: str) -> RenderSettings | None:
    """The RenderSettings prim at a path; None where there is none."""
    prim = stage.GetPrimAtPath(path) if Sdf.Path.IsValidPathString(path) else None
    return RenderSettings(UsdRender.Settings(prim)) if prim and prim.IsA(UsdRender.Settings) else None


def choose_settings(stage: Usd.Stage, path: str) -> None:
    """Choose the settings prim of an opened stage, in its session layer, in place of the one that the stage names.

    Args:
        stage: the stage.
        path: of a RenderSettings prim.

    Raises:
        SettingsError: there is no such prim.
    """
    if settings_at(stage, path) is None:
        known = ", ".join(str(found.GetPath()) for found in stage.Traverse() if found.IsA(UsdRender.Settings))
        raise SettingsError(f"there is no RenderSettings prim at {path!r}; the stage has: {known or 'none'}")
    stage.GetSessionLayer().pseudoRoot.SetInfo(_STAGE_FIELD, path)
