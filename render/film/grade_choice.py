"""Overrides of a shot's grade by the viewer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.colour import ConfigSource, working_config
from render.film.cdl import Cdl

if TYPE_CHECKING:  # a choice by names and numbers needs no USD
    from usd_schemas.settings import GradeData


@dataclass(frozen=True)
class GradeChoice:
    """Overrides of a shot's grade; None keeps the shot's own value.

    Attributes:
        config: an OpenColorIO configuration. The shot's display, view and looks are names in its own configuration, so
            another one ignores them.
        display: display of the configuration. The shot's view is kept where that display has it, else the default is used.
        view: view of the display.
        look: as in `render.film.Grade.look`; empty for none.
        cdl: colour decision.
        space: as in `render.film.Grade.space`: the light as it is, without film and without all of these.
    """

    config: str | None = None
    display: str | None = None
    view: str | None = None
    look: str | None = None
    cdl: Cdl | None = None
    space: str | None = None

    def names_in(self, data: GradeData, config: ConfigSource) -> tuple[str | None, str | None, str | None]:
        """Display, view and look, with the shot's own filled in; None for the configuration's default.

        Args:
            data: the shot's grade.
            config: configuration of the grade, as in `render.film.Grade.config`.

        Raises:
            SettingsError: the configuration cannot be read.
        """
        own_display, own_view, own_look = ("", "", "") if self.config else (data.display, data.view, data.look)
        display, view = self.display or own_display, self.view or own_view
        if self.display and not self.view and own_view not in working_config(config).getViews(display):
            view = ""
        look = own_look if self.look is None else self.look
        return display or None, view or None, look or None
