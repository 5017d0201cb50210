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
from render.output import FrameMetadata
from render.pictures.contact_axes import Axis, Choice, Value
from render.pictures.picture import develop_picture, expose_frame
from render.shot.exposure.readout import ExposureReadout
from render.shot.focus.readout import Readout
from render.shot.lens.lens_choice import LensChoice
from render.shot.light_meter import auto_expose
from render.shot.shot import Shot

if TYPE_CHECKING:  # so that a process without GL can import the shot
    from render.frame import Frame, FrameRenderer, FrameSettings

_LIGHT_AXES = ("lens", "stop", "frame")
"""Axes whose values are rendered anew; the others are applied to the same light."""


@dataclass(frozen=True, eq=False)
class ContactPicture:
    """One picture of a sheet.

    Attributes:
        graded: ``(height, width, 3)`` float32, encoded for the display.
        metadata: of the picture, with its camera and time.
        readout: its lens in numbers.
        exposure: its exposure in numbers.
        film: name of the stock; empty where there is none.
        metered_ev100: exposure value at ISO 100 by the camera's meter; None where the camera does not meter.
    """

    graded: FloatArray
    metadata: FrameMetadata
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
        camera_path: prim path, or empty.
    """

    axes: tuple[Axis, ...]
    pictures: tuple[ContactPicture, ...]
    stage: str
    camera_path: str


def make_contact_sheet(
    renderer: FrameRenderer,
    shot: Shot,
    camera_path: str | None,
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
        camera_path: prim path; None for the shot's default camera.
        time: USD time code, where frames are not compared.
        settings: engine, size and sampling of each picture.
        axes: one, or columns and rows.
        stock: a film of the library in place of the shot's, where stocks are not compared.
        choice: display, view and look, in place of these parts of the shot's grade.
        on_picture: called with the label of the picture at work, and the share of the sheet that is done, from 0 to 1.

    Raises:
        SettingsError: no engine can do this, or the shot's film cannot be developed so.
        CameraError: the camera has impossible values.
        GraphicsError: OpenGL reports an error.
    """
    maker = _SheetMaker(renderer, shot, camera_path, time, settings, stock, choice)
    before = shot.edits.snapshot()
    pictures = []
    try:
        combinations = _combinations(axes)
        for index, (values, label) in enumerate(combinations):
            on_progress = None if on_picture is None else _progress_of(on_picture, label, index, len(combinations))
            shot.edits.restore(before)
            pictures.append(maker.make_picture(values, on_progress))
    finally:
        shot.edits.restore(before)
    return ContactSheet(axes, tuple(pictures), shot.path.name, pictures[0].readout.camera)


def _progress_of(
    on_picture: Callable[[str, float], None], label: str, index: int, count: int
) -> Callable[[float], None]:
    return lambda share: on_picture(label, (index + share) / count)


def _combinations(axes: tuple[Axis, ...]) -> list[tuple[dict[str, Value], str]]:
    """Combine the axes: the values of each picture, and its label, row after row."""
    columns = axes[0]
    rows: Sequence[Choice | None] = axes[1].choices if len(axes) > 1 else (None,)
    combinations = []
    for row in rows:
        for column in columns.choices:
            values = {columns.name: column.value}
            label = column.label
            if row is not None:
                values[axes[1].name] = row.value
                label = f"{label}, {row.label}"
            combinations.append((values, label))
    return combinations


class _SheetMaker:
    """Takes the pictures of a sheet."""

    def __init__(
        self,
        renderer: FrameRenderer,
        shot: Shot,
        camera_path: str | None,
        time: float,
        settings: FrameSettings,
        stock: str | None,
        choice: GradeChoice | None,
    ) -> None:
        self._renderer, self._shot, self._camera_path, self._time = renderer, shot, camera_path, time
        self._settings, self._stock, self._choice = settings, stock, choice
        self._lights: dict[tuple[object, ...], Frame] = {}

    def make_picture(self, values: dict[str, Value], on_progress: Callable[[float], None] | None) -> ContactPicture:
        """Take one picture; light that has been rendered before is used again."""
        shot, settings = self._shot, self._settings
        time = _number(values["frame"]) if "frame" in values else self._time
        self._edit_shot(values, time)
        as_set = shot.camera_at(self._camera_path, time, settings.width, settings.height)
        camera = auto_expose(self._renderer, shot, as_set, time, settings.shading)
        stock = str(values["stock"]) if "stock" in values else self._stock
        finish = shot.film.finish(camera, time, None, stock, self._choice)
        if "push" in values and (finish.film is None or finish.film.stock is None):
            raise SettingsError("only film can be pushed: name a stock, with --film or as what is compared")
        key = tuple(id(value) if isinstance(value := values.get(name), LensChoice) else value for name in _LIGHT_AXES)
        if key not in self._lights:
            self._lights[key] = expose_frame(
                self._renderer, shot, self._camera_path, camera, time, settings, on_progress
            )
        picture = develop_picture(shot, self._lights[key], camera, time, settings, finish)
        film = finish.film.stock.name if finish.film is not None and finish.film.stock is not None else ""
        readout, exposure = shot.focus.read(self._camera_path, time), shot.exposure.read(self._camera_path, time)
        metered = None if camera is as_set else _metered_ev100(exposure, as_set, camera)
        return ContactPicture(picture.graded, picture.metadata, readout, exposure, film, metered)

    def _edit_shot(self, values: dict[str, Value], time: float) -> None:
        shot, camera_path = self._shot, self._camera_path
        if "stop" in values:
            shot.camera.set(camera_path, f_stop=_number(values["stop"]))
        if isinstance(lens := values.get("lens"), LensChoice):
            shot.camera.mount_lens(camera_path, lens)
        if "push" in values:
            shot.film.set(camera_path, push=_number(values["push"]))
        if "exposure" in values:
            authored = shot.exposure.settings(camera_path, time)
            # A meter's reading replaces the camera's own compensation, and has a compensation of its own.
            name = "compensation_stops" if authored["metering_mode"] == "manual" else "metering_compensation_stops"
            shot.exposure.set(camera_path, **{name: (authored[name] or 0.0) + _number(values["exposure"])})


def _metered_ev100(set_to: ExposureReadout, as_set: Camera, metered: Camera) -> float | None:
    """Give the exposure value that the meter chose; None where nothing is exposed."""
    if not (as_set.exposure_scale > 0 and metered.exposure_scale > 0):
        return None
    brighter = math.log2(metered.exposure_scale / as_set.exposure_scale)
    return set_to.ev100 - set_to.settings.compensation_stops - brighter


def _number(value: Value) -> float:
    assert isinstance(value, float)
    return value
