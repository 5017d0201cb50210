"""A contact sheet: one frame of a shot by several stocks, stops, lenses, developments or exposures, or several frames."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from render.errors import SettingsError
from render.film import GradeChoice
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.pictures.contact_axes import Axis, Choice, Value
from render.pictures.picture import develop_picture, expose_frame
from render.shot.exposure.readout import ExposureReadout
from render.shot.focus.readout import Readout
from render.shot.lens.lens_choice import LensChoice
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings

_OF_THE_LIGHT = ("lens", "stop", "frame")
"""What has to be rendered anew; all else is done to the same light."""


@dataclass(frozen=True, eq=False)
class ContactPicture:
    """One picture of a sheet.

    Attributes:
        graded: ``(height, width, 3)`` float32, encoded for the display.
        camera: as it was rendered.
        time: USD time code.
        readout: its lens in numbers.
        exposure: its exposure in numbers.
        film: name of the stock; empty where there is none.
        metered_ev100: exposure value at ISO 100 that a meter made of it; None where none did.
    """

    graded: FloatArray
    camera: Camera
    time: float
    readout: Readout
    exposure: ExposureReadout
    film: str = ""
    metered_ev100: float | None = None


@dataclass(frozen=True, eq=False)
class ContactSheet:
    """Pictures side by side.

    Attributes:
        axes: one, or columns and rows.
        pictures: row after row.
        stage: name of the shot.
        camera: prim path, or empty.
    """

    axes: tuple[Axis, ...]
    pictures: tuple[ContactPicture, ...]
    stage: str
    camera: str


def make_contact_sheet(
    renderer: FrameRenderer,
    shot: Shot,
    camera: str | None,
    time: float,
    settings: FrameSettings,
    axes: tuple[Axis, ...],
    *,
    stock: str | None = None,
    choice: GradeChoice | None = None,
    on_picture: Callable[[str, float], None] | None = None,
) -> ContactSheet:
    """Take all pictures of a sheet. The shot is left as it was.

    A lens is mounted as `Shot.camera.mount_lens` does it: with its own focal length, and no wider than it opens.

    Args:
        renderer: of the calling thread.
        shot: the shot.
        camera: prim path; None for the shot's default camera.
        time: USD time code, where frames are not compared.
        settings: how each picture is rendered.
        axes: what is compared.
        stock: a film of the library in place of the shot's, where stocks are not compared.
        choice: what is wanted of the grade, in place of parts of what the shot says.
        on_picture: called with the name of the picture at work, and how much of the sheet is done, from 0 to 1.

    Raises:
        SettingsError: the shot's film cannot be developed so.
        CameraError: the camera has impossible numbers.
        GraphicsError: the device refuses.
    """
    maker = _Maker(renderer, shot, camera, time, settings, stock, choice)
    before = shot.edits.snapshot()
    pictures = []
    try:
        combinations = _combinations(axes)
        for index, (wanted, label) in enumerate(combinations):
            say = None if on_picture is None else _telling(on_picture, label, index, len(combinations))
            shot.edits.restore(before)
            pictures.append(maker.picture(wanted, say))
    finally:
        shot.edits.restore(before)
    return ContactSheet(axes, tuple(pictures), shot.path.name, pictures[0].readout.camera)


def _telling(on_picture: Callable[[str, float], None], label: str, index: int, count: int) -> Callable[[float], None]:
    return lambda share: on_picture(label, (index + share) / count)


def _combinations(axes: tuple[Axis, ...]) -> list[tuple[dict[str, Value], str]]:
    """What each picture is of, and what it is called, row after row."""
    columns = axes[0]
    rows: Sequence[Choice | None] = axes[1].choices if len(axes) > 1 else (None,)
    made = []
    for row in rows:
        for column in columns.choices:
            wanted = {columns.name: column.value}
            label = column.label
            if row is not None:
                wanted[axes[1].name] = row.value
                label = f"{label}, {row.label}"
            made.append((wanted, label))
    return made


class _Maker:
    """Takes pictures of one shot that differ in some ways."""

    def __init__(
        self,
        renderer: FrameRenderer,
        shot: Shot,
        camera: str | None,
        time: float,
        settings: FrameSettings,
        stock: str | None,
        choice: GradeChoice | None,
    ) -> None:
        self._renderer, self._shot, self._camera, self._time = renderer, shot, camera, time
        self._settings, self._stock, self._choice = settings, stock, choice
        self._lights: dict[tuple[object, ...], Frame] = {}

    def picture(self, wanted: dict[str, Value], on_progress: Callable[[float], None] | None) -> ContactPicture:
        """Take one; light that has been rendered before is not rendered again."""
        shot, settings = self._shot, self._settings
        time = _number(wanted["frame"]) if "frame" in wanted else self._time
        self._set(wanted, time)
        lens = shot.camera_at(self._camera, time, settings.width, settings.height)
        as_set, lens = lens, auto_expose(self._renderer, shot, lens, time, settings.shading)
        stock = str(wanted["stock"]) if "stock" in wanted else self._stock
        finish = shot.film.finish(lens, time, None, stock, self._choice)
        if "push" in wanted and (finish.film is None or finish.film.stock is None):
            raise SettingsError("only film can be pushed: name a stock, with --film or as what is compared")
        key = tuple(id(value) if isinstance(value := wanted.get(name), LensChoice) else value for name in _OF_THE_LIGHT)
        if key not in self._lights:
            self._lights[key] = expose_frame(self._renderer, shot, self._camera, lens, time, settings, on_progress)
        taken = develop_picture(shot, self._lights[key], lens, time, settings, finish)
        film = finish.film.stock.name if finish.film is not None and finish.film.stock is not None else ""
        readout, exposure = shot.focus.read(self._camera, time), shot.exposure.read(self._camera, time)
        metered = None if lens is as_set else _metered_ev100(exposure, as_set, lens)
        return ContactPicture(taken.graded, lens, time, readout, exposure, film, metered)

    def _set(self, wanted: dict[str, Value], time: float) -> None:
        shot, camera = self._shot, self._camera
        if "stop" in wanted:
            shot.camera.set(camera, f_stop=_number(wanted["stop"]))
        if isinstance(lens := wanted.get("lens"), LensChoice):
            shot.camera.mount_lens(camera, lens)
        if "push" in wanted:
            shot.film.set(camera, push=_number(wanted["push"]))
        if "exposure" in wanted:
            said = shot.exposure.settings(camera, time)
            # What a meter says takes the place of the one compensation, and has another of its own.
            name = "compensation_stops" if said["metering_mode"] == "manual" else "metering_compensation_stops"
            shot.exposure.set(camera, **{name: (said[name] or 0.0) + _number(wanted["exposure"])})


def _metered_ev100(set_to: ExposureReadout, as_set: Camera, metered: Camera) -> float | None:
    """The exposure value that a meter's compensation comes to; None where nothing is exposed."""
    if not (as_set.exposure_scale > 0 and metered.exposure_scale > 0):
        return None
    brighter = math.log2(metered.exposure_scale / as_set.exposure_scale)
    return set_to.ev100 - set_to.settings.compensation_stops - brighter


def _number(value: Value) -> float:
    assert isinstance(value, float)
    return value
