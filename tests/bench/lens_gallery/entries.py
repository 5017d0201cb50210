"""Sections and entries of the gallery, and the views of the demo shot that they are photographed in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from render.model.camera import Camera


@dataclass(frozen=True)
class View:
    """A view of the demo shot.

    Attributes:
        name: for captions.
        frame: of the shot.
        move_m: of the shot's camera, in the world (x right, y up, the street leads to -z).
        pitch_deg: upward.
        yaw_deg: to the left.
        focus_m: focus distance; None keeps what the shot's focus points ask for.
        stops: of exposure, so that lights are not too bright for their shapes and colours to show.
        finer: times the rays of other views, where small lights are spread so far that few rays meet them.
    """

    name: str
    frame: float
    move_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    pitch_deg: float = 0.0
    yaw_deg: float = 0.0
    focus_m: float | None = None
    stops: float = 0.0
    finer: int = 1

    def placed(self, camera: Camera) -> Camera:
        """The shot's camera, put there and focused."""
        pitch, yaw = np.radians([self.pitch_deg, self.yaw_deg])
        turn_x, turn_y, place = np.eye(4), np.eye(4), camera.world_from_camera.copy()
        turn_x[1:3, 1:3] = [[np.cos(pitch), -np.sin(pitch)], [np.sin(pitch), np.cos(pitch)]]
        turn_y[0:3:2, 0:3:2] = [[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]]
        place[:3, 3] += self.move_m
        focus_m = camera.focus_distance_m if self.focus_m is None else self.focus_m
        exposure = camera.exposure_scale * 2.0**self.stops
        return replace(
            camera, world_from_camera=place @ turn_y @ turn_x, focus_distance_m=focus_m, exposure_scale=exposure
        )


STREET = View("the shot", 48)
FACE = View("Mara from afar", 64, pitch_deg=5.2, yaw_deg=-6.0, focus_m=7.9)
_UNDER_THE_LIGHTS = View("under the lights", 64, move_m=(0.2, 0.0, -4.0), pitch_deg=12.0, yaw_deg=-3.0, stops=-1.5)
BLURRED_LIGHTS = replace(_UNDER_THE_LIGHTS, name="under the lights, focused before them", focus_m=1.0, finer=2)
SHARP_LIGHTS = replace(_UNDER_THE_LIGHTS, name="under the lights, focused on them", focus_m=9.0)
FAR_LIGHTS = View("the far lights", 64, pitch_deg=8.2, yaw_deg=2.0, focus_m=4.0, stops=-1.5, finer=2)


def as_it_is(camera: Camera) -> Camera:
    """No change."""
    return camera


@dataclass(frozen=True, eq=False)
class Entry:
    """One picture with a detail of it.

    Attributes:
        slug: its files' name.
        title: heading.
        note: what to look at.
        view: where the camera stands.
        lens: of the library, to be mounted; None keeps the shot's, an ideal 50 mm f/1.4.
        change: of the camera, once it stands and has its lens.
        detail: centre of the enlarged detail, in shares of the picture's width and height from its upper left corner.
        rays: of each pixel; None for the size's own.
        wavelengths: traced.
    """

    slug: str
    title: str
    note: str
    view: View
    lens: str | None = None
    change: Callable[[Camera], Camera] = as_it_is
    detail: tuple[float, float] = (0.5, 0.5)
    rays: int | None = None
    wavelengths: int = 3


class Shown(Protocol):
    """Entry as the page shows it."""

    @property
    def slug(self) -> str:
        """Its files' name."""

    @property
    def title(self) -> str:
        """Heading."""

    @property
    def note(self) -> str:
        """Hint on what the pictures show."""

    @property
    def detail(self) -> tuple[float, float]:
        """Centre of the enlarged detail, in shares of the picture's width and height from its upper left corner."""


@dataclass(frozen=True, eq=False)
class Section:
    """Entries that belong side by side.

    Attributes:
        title: heading.
        text: a sentence or two below it.
        entries: the first is often what the others are to be held against.
    """

    title: str
    text: str
    entries: Sequence[Shown]
