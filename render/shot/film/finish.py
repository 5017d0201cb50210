"""What becomes of a shot's light after the lens: its film or sensor, and its grade, as the shot and the asker say."""

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
"""Processes at whose end stands light that is shown as it is, and not scene-linear light that a view is made of."""


@dataclass(frozen=True, eq=False)
class Finish:
    """How a picture is finished at one time.

    Attributes:
        grade: for which display, and how.
        film: what the light falls on; None where the shot says nothing of it.
    """

    grade: Grade
    film: FilmSettings | None = None

    def picture(self, radiance: FloatArray, camera: Camera, *, time: float, seed: int) -> FloatArray:
        """Expose, develop, print and grade.

        Args:
            radiance: ``(height, width, 3 or more)`` scene-linear.
            camera: its gate is the size of the film, its exposure what the light is multiplied by.
            time: USD time code; grain is new in each frame.
            seed: of the render.

        Returns:
            ``(height, width, 3)`` float32, encoded for the display, from 0 to 1.

        Raises:
            SettingsError: the exposure is no number from 0 up, or the film cannot be developed.
        """
        return self.graded(self.developed(radiance, camera, time=time, seed=seed))

    def developed(self, radiance: FloatArray, camera: Camera, *, time: float, seed: int) -> FloatArray:
        """Expose, and develop and print what was exposed: all but the grade. The arguments and errors are those of `picture`.

        Returns:
            ``(height, width, 3)`` float32: light off a print, or scene-linear light.
        """
        check_exposure(camera.exposure_scale)
        exposed = expose(radiance[..., :3], camera.exposure_scale)
        if self.film is None:
            return exposed
        return develop_on_film(exposed, self.film, frame=frame_number(time), gate_mm=gate_mm(camera), seed=seed)

    def graded(self, developed: FloatArray) -> FloatArray:
        """Grade what `developed` gave, for the display."""
        if self.film is not None and self.film.process in PRINTED:
            return project(developed, self.grade, print_space())
        return develop(developed, 1.0, self.grade)


def frame_number(time: float) -> int:
    """The frame that a time code is in: grain and noise are new in each."""
    return int(np.floor(time))


def gate_mm(camera: Camera) -> tuple[float, float]:
    """Width and height of the film itself that the picture covers: an anamorphic lens squeezes it."""
    return camera.horizontal_aperture_mm / camera.lens.squeeze, camera.vertical_aperture_mm


def finish_of(
    stage: Usd.Stage,
    camera: Camera,
    time: float,
    grade: Grade | None = None,
    stock: str | None = None,
    choice: GradeChoice | None = None,
) -> Finish:
    """How a shot's picture is finished.

    Args:
        stage: the shot.
        camera: at that time; one that is no prim says nothing of film.
        time: USD time code.
        grade: in place of all that the shot says of it; None takes what the shot says.
        stock: of the library, in place of the shot's; it has its own grain where its granularity is known and the shot does not
            say how much.
        choice: what is wanted of the grade in place of parts of what the shot says.

    Raises:
        SettingsError: the library has no such stock, or what is wanted of the grade cannot be had.
        CameraError: what the shot says of film or grade makes no sense, or a value of the camera is of another type or another
            token than its schema has.
        InputError: a file of the grade is missing or damaged.
    """
    data = _film_data(stage, camera, time)
    with _told_of(camera, wanted=choice is not None):
        own = Grade.from_film_data(data.grade, confinement(stage), choice) if grade is None else grade
    with _told_of(camera, wanted=stock is not None):
        film = film_settings(data, iso=_set_to(stage, camera, time), name=stock)
        if film.process == "none" and film.white_balance_k == 0 and film.tint == 0:
            return Finish(own)
        if stock is not None and data.grain.amount == 0 and film.stock is not None and film.stock.granularity:
            film = replace(film, grain=replace(film.grain, amount=1.0))
        return Finish(own, film)


@contextmanager
def _told_of(camera: Camera, *, wanted: bool) -> Iterator[None]:
    """Tell what is wrong with a setting as the camera's fault, unless whoever looks at it wanted it so."""
    try:
        yield
    except SettingsError as error:
        if wanted:
            raise
        raise CameraError(f"camera {camera.path}: {error.detail}", code=error.code, path=camera.path) from error


def _set_to(stage: Usd.Stage, camera: Camera, time: float) -> float:
    """The speed that the shot sets the camera to; 0 where it does not."""
    speed = stage.GetPrimAtPath(camera.path).GetAttribute("exposure:iso") if camera.path else None
    return float(speed.Get(time)) if speed and speed.HasAuthoredValue() else 0.0


def _film_data(stage: Usd.Stage, camera: Camera, time: float) -> FilmData:
    prim = stage.GetPrimAtPath(camera.path) if camera.path else None
    if not prim:
        return FilmData()
    own = LensCamera(prim)
    try:
        with quiet_diagnostics():
            for misread in own.misread(time):
                raise _misread(misread, camera.path)
            return own.film.read(time)
    except SchemaError as error:
        raise CameraError(str(error), path=camera.path) from error


def _misread(said: Misread, path: str) -> CameraError:
    if said.type:
        expected, code = f"must be of type {said.type}, got {said.got}", "wrong_type"
    else:
        expected, code = f"has no meaning for '{said.got}': {hint(said.got, said.tokens)}", "unknown_token"
    return CameraError(f"{said.name} of camera {path} {expected}", code=code, path=path)
