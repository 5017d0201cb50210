"""What somebody who looks at a shot wants of its grade, in place of what the shot says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.colour import working_config
from render.film.cdl import Cdl

if TYPE_CHECKING:  # a choice by names and numbers needs no USD
    from usd_schemas.settings import GradeData


@dataclass(frozen=True)
class GradeChoice:
    """Wishes, each of which stands in for what the shot says of the same; None leaves it to the shot.

    Attributes:
        config: an OpenColorIO configuration. The shot's display, view and looks are words of its own configuration, so with
            another one they no longer count.
        display: of the configuration. The shot's view stays where that display has it, else the display's default one is taken.
        view: of the display.
        look: as `render.film.Grade.look`; empty for none.
        cdl: the colour decision.
    """

    config: str | None = None
    display: str | None = None
    view: str | None = None
    look: str | None = None
    cdl: Cdl | None = None

    def words(self, data: GradeData, config: str | None) -> tuple[str | None, str | None, str | None]:
        """Display, view and look, with what the shot says filled in; None for the configuration's default.

        Args:
            data: what the shot says.
            config: the configuration that the grade is by, as `render.film.Grade.config`.

        Raises:
            SettingsError: the configuration cannot be read.
        """
        own_display, own_view, own_look = ("", "", "") if self.config else (data.display, data.view, data.look)
        display, view = self.display or own_display, self.view or own_view
        if self.display and not self.view and own_view not in working_config(config).getViews(display):
            view = ""
        look = own_look if self.look is None else self.look
        return display or None, view or None, look or None
