"""Finish of a picture: film or sensor, and grade, from the shot's settings and the caller's choices."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
from pxr import Usd

from render.errors import CameraError, SettingsError
from render.film import FilmSettings, Grade, GradeChoice, develop, develop_on_film, film_settings, print_space, project
from render.film.develop import check_exposure, expose
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.near_names import hint
from render.stage import quiet_diagnostics
from render.stage.opening import confinement
from usd_schemas import FilmData, LensCamera, SchemaError
from usd_schemas.view import Misread

PRINTED = ("negative", "reversal", "monochrome")
"""Processes whose result is the light off a print or slide, to be shown as it is, and not scene-linear light for a view."""


@dataclass(frozen=True, eq=False)
class Finish:
    """Finish of a picture at one time.

    Attributes:
        grade: display, view, look and color decision list.
        film: film or sensor; None where the shot has neither.
    """

    grade: Grade
    film: FilmSettings | None = None

    def apply(self, radiance: FloatArray, camera: Camera, *, time: float, seed: int) -> FloatArray:
        """Expose, develop, print and grade.

        Args:
            radiance: ``(height, width, 3 or more)`` scene-linear.
            camera: its gate is the size of the film, its exposure scale multiplies the light.
            time: USD time code; grain is new in each frame.
            seed: of the render.

        Returns:
            ``(height, width, 3)`` float32, encoded for the display, from 0 to 1.

        Raises:
            SettingsError: the exposure is no number from 0 up, or the film cannot be developed.
        """
        return self.apply_grade(self.develop(radiance, camera, time=time, seed=seed))

    def develop(self, radiance: FloatArray, camera: Camera, *, time: float, seed: int) -> FloatArray:
        """Expose, develop and print, without the grade. Arguments and errors are those of `apply`.

        Returns:
            ``(height, width, 3)`` float32: light off a print, or scene-linear light.
        """
        check_exposure(camera.exposure_scale)
        exposed = expose(radiance[..., :3], camera.exposure_scale)
        if self.film is None:
            return exposed
        return develop_on_film(exposed, self.film, frame=frame_number(time), gate_mm=gate_mm(camera), seed=seed)

    def apply_grade(self, developed: FloatArray) -> FloatArray:
        """Grade a developed picture for the display.

        Args:
            developed: from `develop`.
        """
        if self.film is not None and self.film.process in PRINTED:
            return project(developed, self.grade, print_space())
        return develop(developed, 1.0, self.grade)


def frame_number(time: float) -> int:
    """Number of the frame that contains a time code, 0 at the default time; grain and noise differ between frames."""
    return 0 if np.isnan(time) else int(np.floor(time))


def gate_mm(camera: Camera) -> tuple[float, float]:
    """Width and height of the exposed film; an anamorphic lens squeezes the picture onto it."""
    return camera.horizontal_aperture_mm / camera.lens.squeeze, camera.vertical_aperture_mm


def read_finish(
    stage: Usd.Stage,
    camera: Camera,
    time: float,
    grade: Grade | None = None,
    stock: str | None = None,
    choice: GradeChoice | None = None,
) -> Finish:
    """Read how a shot's picture is finished.

    Args:
        stage: the shot.
        camera: at that time; one that is no prim has no film.
        time: USD time code.
        grade: replaces the shot's grade; None keeps it.
        stock: name in the library, replaces the shot's; it has its own grain where its granularity is known and the shot sets no
            amount.
        choice: replaces parts of the shot's grade.

    Raises:
        SettingsError: the library has no such stock, or the choice of grade is impossible.
        CameraError: a film or grade setting of the shot makes no sense, or a value of the camera has another type or another
            token than its schema allows.
        InputError: a file of the grade is missing or damaged.
    """
    data = _film_data(stage, camera, time)
    with _blame_camera(camera, unless=choice is not None):
        shot_grade = Grade.from_film_data(data.grade, confinement(stage), choice) if grade is None else grade
    if choice is not None and choice.space is not None:
        return Finish(shot_grade)
    with _blame_camera(camera, unless=stock is not None):
        film = film_settings(data, iso=_authored_iso(stage, camera, time), name=stock)
        if film.process == "none" and film.white_balance_k == 0 and film.tint == 0:
            return Finish(shot_grade)
        if stock is not None and data.grain.amount == 0 and film.stock is not None and film.stock.granularity:
            film = replace(film, grain=replace(film.grain, amount=1.0))
        return Finish(shot_grade, film)


@contextmanager
def _blame_camera(camera: Camera, *, unless: bool) -> Iterator[None]:
    """Raise a settings error as the camera's, unless the setting is the caller's."""
    try:
        yield
    except SettingsError as error:
        if unless:
            raise
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error


def _authored_iso(stage: Usd.Stage, camera: Camera, time: float) -> float:
    """Authored ISO speed of the camera; 0 where it has none."""
    speed = stage.GetPrimAtPath(camera.path).GetAttribute("exposure:iso") if camera.path else None
    return float(speed.Get(time)) if speed and speed.HasAuthoredValue() else 0.0


def _film_data(stage: Usd.Stage, camera: Camera, time: float) -> FilmData:
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    if not prim:
        return FilmData()
    view = LensCamera(prim)
    try:
        with quiet_diagnostics():
            for misread in view.misread(time):
                raise _misread_error(misread, camera.path)
            return view.film.read(time)
    except SchemaError as error:
        raise CameraError(str(error), path=camera.path) from error


def _misread_error(misread: Misread, path: str) -> CameraError:
    if misread.type:
        expected, code = f"must be of type {misread.type}, got {misread.got}", "wrong_type"
    else:
        expected, code = f"has no meaning for '{misread.got}': {hint(misread.got, misread.tokens)}", "unknown_token"
    return CameraError(f"{misread.name} of camera {path} {expected}", code=code, path=path)
