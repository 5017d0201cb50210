"""The film part of a shot: film and grade settings, stocks of the library, and how pictures are finished."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from pxr import Usd

from render.errors import SettingsError
from render.film import Grade, GradeChoice
from render.film.stock import camera_stock
from render.model.camera import Camera
from render.shot.camera.attributes import author_settings, read_settings, setting_label
from render.shot.camera.lookup import CameraLookup
from render.shot.edits.edit_layer import Edits
from render.shot.film.finish import Finish, read_finish
from usd_schemas import FilmData, LensCamera, LibraryFilm
from usd_schemas.applying import applied
from usd_schemas.binding import author_for_all_time, property_values
from usd_schemas.settings.tables import FILM_SETTINGS

_STOCK_SETTINGS = ("stock", "print_stock", "process", "speed", "curve", "print_curve", "grain_rms")
"""Prefixes of the names of all film settings that come with a stock."""


class ShotFilm:
    """Film and grade of the cameras of one shot.

    Args:
        stage: the shot.
        edits: where edits go.
        cameras: finds cameras by path.
    """

    def __init__(self, stage: Usd.Stage, edits: Edits, cameras: CameraLookup) -> None:
        self._stage = stage
        self._edits = edits
        self._cameras = cameras

    def settings(self, camera_path: str | None, time: float) -> Mapping[str, Any]:
        """Film or sensor and grade of a camera, by the names of `FILM_SETTINGS`.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        return read_settings(self._cameras.camera(camera_path), FILM_SETTINGS, time)

    def set(self, camera_path: str | None, *, time: float | None = None, **settings: Any) -> None:
        """Change film or sensor, and grade.

        Args:
            camera_path: of a camera.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time. Words, files and
                other things that cannot change over time hold for all time either way.
            settings: by the names of `FILM_SETTINGS`.

        Raises:
            SettingsError: there is no such setting, a value is out of range, or the time is not finite.
        """
        camera = self._cameras.editable(camera_path)
        unknown = set(settings) - set(FILM_SETTINGS)
        if unknown:
            raise SettingsError(f"the film has no {', '.join(sorted(unknown))} to set", code="bad_field")
        labels = ", ".join(map(setting_label, settings))
        with self._edits.transaction(f"set {labels} of {camera.prim.GetName()}"):
            author_settings(camera, settings, time)

    def mount_stock(self, camera_path: str | None, stock: LibraryFilm | None) -> None:
        """Put a stock of the library in a camera, for all time: its process and its curves, rated at box speed.

        A negative goes with the print that it is usually made on, and film whose granularity is known with its grain, unless
        there was film in the camera before: then print and amount of grain stay. So do push and white balance.

        Args:
            camera_path: of a camera.
            stock: of the library, for the camera; None takes the film out.

        Raises:
            SettingsError: it is a print stock.
        """
        camera = self._cameras.editable(camera_path)
        if stock is not None and stock.kind != "camera":
            raise SettingsError(f"{stock.name} is a print stock, expected one for the camera", code="unknown_stock")
        name = stock.title if stock else "no film"
        with self._edits.transaction(f"put {name} in {camera.prim.GetName()}"):
            _author_stock(camera, stock)

    def finish(
        self,
        camera: Camera,
        time: float,
        grade: Grade | None = None,
        stock: str | None = None,
        choice: GradeChoice | None = None,
    ) -> Finish:
        """Read how a picture is finished (`render.shot.film.finish.read_finish`, which has the arguments and errors)."""
        return read_finish(self._stage, camera, time, grade, stock, choice)


def _author_stock(camera: LensCamera, stock: LibraryFilm | None) -> None:
    before, default = camera.film.read(), FilmData()
    film = default if stock is None else stock.film
    had_film = before.process not in ("none", "digital")
    after = replace(
        default,
        process=film.process,
        stock=stock.name if stock else "",
        print_stock=before.print_stock if had_film and film.process == before.process else film.print_stock,
        grain=replace(before.grain, rms=default.grain.rms),
    )
    if stock is not None and not had_film and camera_stock(stock.name).granularity:
        after = replace(after, grain=replace(after.grain, amount=1.0))
    values = dict(property_values(after))
    properties = [item.usd for name, item in FILM_SETTINGS.items() if name.startswith(_STOCK_SETTINGS)]
    with applied(camera.prim, "FilmAPI"):
        for usd in (*properties, "film:grain:amount"):
            author_for_all_time(camera.prim.GetAttribute(usd), values[usd])
