"""Which display a picture is made for, in the words of an OpenColorIO configuration."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import PyOpenColorIO

from render.colour import working_config
from render.errors import SettingsError
from render.near_names import hint


@dataclass(frozen=True)
class Grade:
    """How radiance is turned into a display's picture. Names are checked when a grade is made.

    Attributes:
        config: an OpenColorIO configuration, by path or as ``ocio://name``; None takes the one that the environment
            variable ``OCIO`` names, else OpenColorIO's default built-in one.
        display: a display of that configuration; None takes its default.
        view: a view of that display; None takes its default.
        look: looks of that configuration, applied in the working space before the view, with OpenColorIO's syntax
            (names separated by commas, ``-name`` for the inverse); None for none.

    Raises:
        SettingsError: the configuration cannot be read, or has no such display, view or look; the message has the
            nearest names, else all.
    """

    config: str | None = None
    display: str | None = None
    view: str | None = None
    look: str | None = None

    def __post_init__(self) -> None:
        known = list_displays(self.config)
        _check_known("display", self.display_name, known)
        _check_known("view", self.view_name, known[self.display_name], f" of display '{self.display_name}'")
        for look in _look_names(self.look):
            _check_known("look", look, working_config(self.config).getLookNames())

    @property
    def display_name(self) -> str:
        """The display, with the configuration's default filled in."""
        return self.display or str(working_config(self.config).getDefaultDisplay())

    @property
    def view_name(self) -> str:
        """The view, with the display's default filled in."""
        return self.view or str(working_config(self.config).getDefaultView(self.display_name))

    @property
    def working_space(self) -> str:
        """Name of the scene-linear space that the radiance is in."""
        return str(working_config(self.config).getRoleColorSpace(PyOpenColorIO.ROLE_SCENE_LINEAR))

    @property
    def working_space_id(self) -> str:
        """Colour interop id of the working space, such as ``lin_ap1_scene``; empty if the configuration says none."""
        return str(working_config(self.config).getColorSpace(self.working_space).getInteropID())

    @property
    def picture_space_id(self) -> str:
        """Colour interop id of the developed picture, such as ``srgb_rec709_display``; empty where it has none."""
        config = working_config(self.config)
        space = config.getColorSpace(config.getResolvedDisplayViewColorSpaceName(self.display_name, self.view_name))
        return str(space.getInteropID()) if space else ""

    def cpu_processor(self) -> PyOpenColorIO.CPUProcessor:
        """OpenColorIO's processor from the working space to the display, which OpenColorIO caches.

        Raises:
            SettingsError: OpenColorIO cannot build the transform, such as when a file that a look names is missing.
        """
        transform = PyOpenColorIO.GroupTransform()
        if self.look:
            transform.appendTransform(
                PyOpenColorIO.LookTransform(
                    src=PyOpenColorIO.ROLE_SCENE_LINEAR, dst=PyOpenColorIO.ROLE_SCENE_LINEAR, looks=self.look
                )
            )
        transform.appendTransform(
            PyOpenColorIO.DisplayViewTransform(
                src=PyOpenColorIO.ROLE_SCENE_LINEAR, display=self.display_name, view=self.view_name
            )
        )
        try:
            return working_config(self.config).getProcessor(transform).getDefaultCPUProcessor()
        except (PyOpenColorIO.Exception, PyOpenColorIO.ExceptionMissingFile) as error:
            raise SettingsError(
                f"display '{self.display_name}' with view '{self.view_name}' cannot be made: {error}", code="bad_grade"
            ) from error


def list_displays(config: str | None = None) -> dict[str, tuple[str, ...]]:
    """Displays of a configuration and the views of each, in the configuration's order.

    Args:
        config: as `Grade.config`.

    Raises:
        SettingsError: the configuration cannot be read.
    """
    read = working_config(config)
    return {display: tuple(read.getViews(display)) for display in read.getDisplays()}


def _look_names(look: str | None) -> list[str]:
    """The names in OpenColorIO's look syntax, without the signs of direction."""
    options = (look or "").replace(":", ",").replace("|", ",")
    return [name for part in options.split(",") if (name := part.strip().lstrip("+-").strip())]


def _check_known(kind: str, name: str, known: Iterable[str], of_what: str = "") -> None:
    """Raise `SettingsError` unless ``name`` is one of ``known``."""
    names = list(known)
    if name not in names:
        raise SettingsError(f"unknown {kind} '{name}'{of_what}: {hint(name, names)}", code=f"unknown_{kind}")
