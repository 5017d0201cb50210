"""The edits of one opened shot that say how a camera takes the picture: its exposure, shutter, film and body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from render.errors import PullfocusError, SettingsError
from render.film.stock import camera_stock
from render.model.shutter import moments
from render.shot.edits.camera_attributes import EXPOSURE_SETTINGS, FILM_SETTINGS, CameraAttribute, author_settings
from render.shot.edits.camera_edits import CameraEdits
from render.shot.edits.edit_layer import schema_errors_as_settings
from render.shot.exposure.keys import author_exposure, keyed_stops
from render.shot.exposure.light_meter import Metered
from render.shot.film.finish import finish_of
from render.shot.view import checked_time
from usd_schemas import FilmData, LensCamera, LibraryBody, LibraryFilm, mount_body
from usd_schemas.applying import applied
from usd_schemas.binding import author_for_all_time, property_values

_TRIED_PX = (16, 9)
_OF_THE_STOCK = ("stock", "print_stock", "process", "speed", "curve", "print_curve", "grain_rms")


class PhotographyEdits(CameraEdits):
    """The part of `Shot` that edits how a camera exposes, and on what."""

    def photography(self, camera_path: str | None, time: float) -> Mapping[str, Any]:
        """All that says how a camera exposes and on what, by the names of `EXPOSURE_SETTINGS` and `FILM_SETTINGS`.

        Args:
            camera_path: of a camera.
            time: USD time code.
        """
        camera = self._lens_camera(camera_path)
        with schema_errors_as_settings():
            film = dict(property_values(camera.film.read(checked_time(time))))
            lens = dict(property_values(camera.lens.read(time)))
        said = {name: film[usd] for name, (_, usd) in FILM_SETTINGS.items()}
        for name, (schema, usd) in EXPOSURE_SETTINGS.items():
            said[name] = lens[usd] if schema else CameraAttribute(camera, name).value(time)
        return said

    def set_photography(self, camera_path: str | None, *, time: float | None = None, **settings: Any) -> None:
        """Change how a camera exposes, and on what.

        Args:
            camera_path: of a camera.
            time: USD time code of the keys; None drops the keys there are and holds the values for all time. Words, files and
                other things that cannot change over time hold for all time either way.
            settings: by the names of `EXPOSURE_SETTINGS` and `FILM_SETTINGS`.

        Raises:
            SettingsError: there is no such setting, a value is out of range, or the time is not finite.
        """
        camera = self._editable(camera_path)
        unknown = set(settings) - set(EXPOSURE_SETTINGS) - set(FILM_SETTINGS)
        if unknown:
            raise SettingsError(f"a camera exposes without {', '.join(sorted(unknown))}", code="bad_field")
        said = ", ".join(name.replace("_", " ") for name in settings)
        with self._edits.editing(f"set {said} of {camera.prim.GetName()}"):
            author_settings(camera, settings, time)

    def key_exposure(self, camera_path: str | None, said: Sequence[Metered], *, held: bool = False) -> None:
        """Expose a camera from now on by hand, as a light meter says.

        Args:
            camera_path: of a camera.
            said: by the meter, in order of time.
            held: one exposure for all of them, in place of a native spline.

        Raises:
            InputError: every frame is black.
        """
        camera, stops = self._editable(camera_path), keyed_stops(said, held=held)
        with self._edits.editing(f"key the metered exposure of {camera.prim.GetName()}"):
            author_exposure(camera, [one.time for one in said], stops)

    def mount_film(self, camera_path: str | None, stock: LibraryFilm | None) -> None:
        """Put a stock of the library in a camera, for all time: its process and its curves, rated as it is on the box.

        A negative goes with the print that it is usually made on, and film whose granularity is known with its grain, unless
        there was film in the camera before: then print and amount of grain stay. So do push and white balance.

        Args:
            camera_path: of a camera.
            stock: of the library, for the camera; None takes the film out.

        Raises:
            SettingsError: it is a print stock.
        """
        camera = self._editable(camera_path)
        if stock is not None and stock.kind != "camera":
            raise SettingsError(f"{stock.name} is a print stock, expected one for the camera", code="unknown_stock")
        name = stock.title if stock else "no film"
        with self._edits.editing(f"put {name} in {camera.prim.GetName()}"):
            _load(camera, stock)

    def mount_body(self, camera_path: str | None, body: LibraryBody) -> None:
        """Give a camera another body, for all time: its gate, its photosites and its name.

        Args:
            camera_path: of a camera.
            body: of the library.
        """
        camera = self._editable(camera_path)
        with self._edits.editing(f"put the {body.title} on {camera.prim.GetName()}"):
            mount_body(camera, body)

    @contextmanager
    def kept_usable(self, camera_path: str | None, time: float) -> Iterator[None]:
        """Refuse edits after which no picture can be made that could be made before.

        Args:
            camera_path: of the camera that is edited.
            time: USD time code of the picture.

        Raises:
            PullfocusError: what the next picture would be refused with.
        """
        before = self._refusal(camera_path, time)
        yield
        after = self._refusal(camera_path, time)
        if after is not None and str(after) != str(before):
            raise after

    def _refusal(self, camera_path: str | None, time: float) -> PullfocusError | None:
        """Why no picture can be made."""
        try:
            camera = self.camera_at(camera_path, time, *_TRIED_PX)
            finish_of(self.stage, camera, time)
            moments(camera.shutter_open, camera.shutter_close, camera.shutter, 1)
        except PullfocusError as error:
            return error
        return None


def _load(camera: LensCamera, stock: LibraryFilm | None) -> None:
    said, new = camera.film.read(), FilmData()
    film = new if stock is None else stock.film
    had_film = said.process not in ("none", "digital")
    wanted = replace(
        new,
        process=film.process,
        stock=stock.name if stock else "",
        print_stock=said.print_stock if had_film and film.process == said.process else film.print_stock,
        grain=replace(said.grain, rms=new.grain.rms),
    )
    if stock is not None and not had_film and camera_stock(stock.name).granularity:
        wanted = replace(wanted, grain=replace(wanted.grain, amount=1.0))
    values = dict(property_values(wanted))
    properties = [usd for name, (_, usd) in FILM_SETTINGS.items() if name.startswith(_OF_THE_STOCK)]
    with applied(camera.prim, "FilmAPI"):
        for usd in (*properties, "film:grain:amount"):
            author_for_all_time(camera.prim.GetAttribute(usd), values[usd])
