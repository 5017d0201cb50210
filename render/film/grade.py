"""Grade: display, view and look of a picture, by the names of an OpenColorIO configuration."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import PyOpenColorIO

from render.colour import DEFAULT_CONFIG, OCIO_ERRORS, ConfigSource, config_name, working_config
from render.colour.confined import ConfinedConfig
from render.errors import SettingsError
from render.film.cdl import NEUTRAL, Cdl, read_cdl
from render.film.display_transform import TransformChain, print_to_display, scene_to_display, scene_to_space
from render.film.grade_choice import GradeChoice
from render.near_names import hint

if TYPE_CHECKING:  # a grade by names and numbers needs no USD
    from usd_schemas.settings import GradeData


@dataclass(frozen=True)
class Grade:
    """Transform from scene light to a display's picture. The constructor checks that it can be built.

    Attributes:
        config: an OpenColorIO configuration, by path or as ``ocio://name``; None takes the one used for rendering: the one that
            the environment variable ``OCIO`` names, else OpenColorIO's default built-in one. That of a shot from outside is
            confined to the shot's folder.
        display: a display of that configuration; None takes its default.
        view: a view of that display; None takes its default.
        look: looks of that configuration, applied in the working space before the view, with OpenColorIO's syntax
            (names separated by commas, ``-name`` for the inverse); None for none.
        cdl: the shot's colour decision, applied before the looks in the configuration's ``color_timing`` space, or in the
            working space where it has none.
        space: colour space of OpenColorIO's default configuration that light is encoded in, such as ``srgb_texture``, in place of
            display, view, look and CDL; None for these.

    Raises:
        SettingsError: the configuration cannot be read, or has no such display, view or look; the message has the
            nearest names, else all. Or OpenColorIO cannot build the transform, such as when a file that a look names is
            missing.
    """

    config: str | ConfinedConfig | None = None
    display: str | None = None
    view: str | None = None
    look: str | None = None
    cdl: Cdl = NEUTRAL
    space: str | None = None

    def __post_init__(self) -> None:
        known = list_displays(self.config)
        _check_known("display", self.display_name, known)
        _check_known("view", self.view_name, known[self.display_name], f" of display '{self.display_name}'")
        for look in _look_names(self.look):
            _check_known("look", look, working_config(self.config).getLookNames())
        self.processor()

    @classmethod
    def from_film_data(
        cls, data: GradeData, confined_to: Path | None = None, choice: GradeChoice | None = None
    ) -> Grade:
        """Grade from a shot's ``film:ocio:*`` and ``film:cdl:*``.

        Args:
            data: as it is at a time; a CDL file takes the place of the CDL's numbers.
            confined_to: a folder that holds all that the shot may read; None where it may read everything.
            choice: overrides of the viewer, which may read files anywhere.

        Raises:
            SettingsError: as when a grade is made, or a number of the CDL is out of range.
            InputError: a file is missing, damaged or outside of the folder, or has no such correction.
        """
        from render.film.shot_files import cdl_file, config_file

        choice = choice or GradeChoice()
        if choice.space is not None:
            return cls(space=choice.space)
        config = choice.config or config_file(data.ocio_config, confined_to)
        if choice.cdl is not None:
            cdl = choice.cdl
        elif data.cdl_file.path:
            cdl = read_cdl(cdl_file(data.cdl_file, confined_to), data.cdl_id)
        else:
            cdl = Cdl(data.cdl_slope, data.cdl_offset, data.cdl_power, data.cdl_saturation)
        return cls(config, *choice.names_in(data, config), cdl)

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
        """Name of the scene-linear space that the radiance is in, in the configuration that was rendered by."""
        return str(working_config().getRoleColorSpace(PyOpenColorIO.ROLE_SCENE_LINEAR))

    @property
    def working_space_id(self) -> str:
        """Colour interop id of the working space, such as ``lin_ap1_scene``; empty if the configuration gives none."""
        return str(working_config().getColorSpace(self.working_space).getInteropID())

    @property
    def picture_space_id(self) -> str:
        """Colour interop id of the developed picture, such as ``srgb_rec709_display``; empty where it has none."""
        if self.space is not None:
            return str(working_config(DEFAULT_CONFIG).getColorSpace(self.space).getInteropID())
        config = working_config(self.config)
        space = config.getColorSpace(config.getResolvedDisplayViewColorSpaceName(self.display_name, self.view_name))
        return str(space.getInteropID()) if space else ""

    def processor(self, light: str | None = None) -> PyOpenColorIO.Processor:
        """OpenColorIO's transform from light to the display's picture; OpenColorIO caches it.

        Args:
            light: None for scene-linear light in the working space, which the view tone-maps. Else the name of a linear space,
                of the configuration that was rendered by or of OpenColorIO's default one, such as ``lin_rec709``, in which there
                is the light of a film's print: it is shown as it is, its 1 as the display's white, with the CDL and the looks but
                no tone mapping.

        Raises:
            SettingsError: OpenColorIO cannot build the transform.
        """
        config = working_config(self.config)
        with self._translate_errors(light):
            return config.getProcessor(self._way(light).with_cdl(self.cdl))

    def processors_around_cdl(self, light: str | None = None) -> list[PyOpenColorIO.Processor]:
        """As `processor`, but in two parts where there is a CDL, which works between them; they do not depend on its numbers."""
        config = working_config(self.config)
        with self._translate_errors(light):
            return [config.getProcessor(part) for part in self._way(light).parts]

    def cpu_processor(self, light: str | None = None) -> PyOpenColorIO.CPUProcessor:
        """`processor` for arrays."""
        return self.processor(light).getDefaultCPUProcessor()

    def _way(self, light: str | None) -> TransformChain:
        if self.space is not None:
            return scene_to_space(self.space)
        way = (working_config(self.config), self.display_name, self.view_name, self.look, not self.cdl.is_neutral)
        return scene_to_display(*way) if light is None else print_to_display(*way, light)

    @contextmanager
    def _translate_errors(self, light: str | None) -> Iterator[None]:
        """Translate OpenColorIO's errors into `SettingsError`."""
        try:
            yield
        except OCIO_ERRORS as error:
            shown = "" if light is None else f" of a print in '{light}'"
            raise SettingsError(
                f"display '{self.display_name}' with view '{self.view_name}'{shown} cannot be made: {self._reason(error)}",
                code="bad_grade",
            ) from error

    def _reason(self, error: Exception) -> str:
        """OpenColorIO's error message, or, for a missing role, which configuration lacks it and what the role is for."""
        role = PyOpenColorIO.ROLE_INTERCHANGE_SCENE
        if role in str(error):
            for config in (self.config, None):
                if not working_config(config).hasRole(role):
                    return (
                        f"the OpenColorIO configuration {config_name(config)} lacks the role {role}, by which light is handed "
                        f"from one configuration to another: add it to the roles, naming the colour space that is ACES2065-1"
                    )
        said = " ".join(str(error).split())
        return self.config.as_sent(said) if isinstance(self.config, ConfinedConfig) else said


def list_displays(config: ConfigSource = None) -> dict[str, tuple[str, ...]]:
    """Displays of a configuration and the views of each, in the configuration's order.

    Args:
        config: as `Grade.config`.

    Raises:
        SettingsError: the configuration cannot be read.
    """
    read = working_config(config)
    return {display: tuple(read.getViews(display)) for display in read.getDisplays()}


def list_looks(config: ConfigSource = None) -> tuple[str, ...]:
    """Looks of a configuration, in its order.

    Args:
        config: as `Grade.config`.

    Raises:
        SettingsError: the configuration cannot be read.
    """
    return tuple(working_config(config).getLookNames())


def _look_names(look: str | None) -> list[str]:
    """The names in OpenColorIO's look syntax, without the signs of direction."""
    options = (look or "").replace(":", ",").replace("|", ",")
    return [name for part in options.split(",") if (name := part.strip().lstrip("+-").strip())]


def _check_known(kind: str, name: str, known: Iterable[str], of_what: str = "") -> None:
    """Raise `SettingsError` unless ``name`` is one of ``known``."""
    names = list(known)
    if name not in names:
        raise SettingsError(f"unknown {kind} '{name}'{of_what}: {hint(name, names)}", code=f"unknown_{kind}")
