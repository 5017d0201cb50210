"""Options of `pullfocus record` that set the camera for one run: body, stop, exposure, light meter, and framing guides."""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from render.cli.console import print_message
from render.cli.options import shared
from render.cli.options.settings import add_settings, read_seconds, read_settings
from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.near_names import hint
from render.optics.framing import Gate, framing_guide, shape
from render.optics.photometry.exposure import ExposureSettings, shutter_time_s
from render.output import format_of
from render.output.formats import movie_format_of
from render.shot import Shot
from render.stage import read_camera
from usd_schemas import LibraryBody, SchemaError, library_body
from usd_schemas.settings.tables import EXPOSURE_SETTINGS, FILM_SETTINGS

if TYPE_CHECKING:  # matplotlib takes a second to load
    from render.drawing.guides import Guide

METERING = ("manual", "center", "average", "spot")


@dataclass(frozen=True)
class ShutterTime:
    """Time that a shutter is open.

    Attributes:
        angle_rad: of a rotating shutter; 0 where the time is given in seconds.
        time_s: 0 where the time is given as an angle.
    """

    angle_rad: float = 0.0
    time_s: float = 0.0

    def seconds(self, frames_per_second: float) -> float:
        """Time in seconds at a frame rate.

        Raises:
            SettingsError: the angle is more than a full turn.
        """
        return shutter_time_s(self.angle_rad, frames_per_second) if self.angle_rad else self.time_s


@dataclass(frozen=True)
class CameraOptions:
    """Camera settings of one run.

    Attributes:
        body: of the library; None keeps the shot's.
        crop: width over height of the central part of the gate that is exposed; None exposes all of it.
        f_stop: of the iris; None keeps the shot's.
        shutter: time that it is open; None keeps the shot's.
        settings: of exposure and film, by name.
        compensation_stops: of the exposure, or of the meter where the shot is metered; None keeps the shot's.
        guides: drawn over graded pictures.
    """

    body: LibraryBody | None = None
    crop: float | None = None
    f_stop: float | None = None
    shutter: ShutterTime | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    compensation_stops: float | None = None
    guides: tuple[Guide, ...] = ()

    def set_on(self, shot: Shot, camera_path: str | None) -> None:
        """Set the camera for this run alone, and print what that changed.

        Args:
            shot: the shot.
            camera_path: prim path; None for a camera that frames the whole stage.

        Raises:
            InputError: there is no camera to set.
            SettingsError: a value is out of range.
        """
        if self.body is not None:
            shot.camera.mount_body(camera_path, self.body)
            width, height = self.body.gate_mm
            print_message(f"body: {self.body.title} (gate {width:g} × {height:g} mm)")
        if self.crop is not None:
            self._crop(shot, camera_path, self.crop)
        if self.f_stop is not None:
            shot.camera.set(camera_path, f_stop=self.f_stop)
        if self.shutter is not None:
            self._set_shutter(shot, camera_path, self.shutter)
        exposure = {name: value for name, value in self.settings.items() if name in EXPOSURE_SETTINGS}
        film = {name: value for name, value in self.settings.items() if name in FILM_SETTINGS}
        if exposure:
            shot.exposure.set(camera_path, **exposure)
        if film:
            shot.film.set(camera_path, **film)
        if self.compensation_stops is not None:
            is_metered = shot.exposure.settings(camera_path, shot.frame_range.start)["metering_mode"] != "manual"
            name = "metering_compensation_stops" if is_metered else "compensation_stops"
            shot.exposure.set(camera_path, **{name: self.compensation_stops})

    def _crop(self, shot: Shot, camera_path: str | None, aspect: float) -> None:
        """Reduce gate and photosites to the largest central frame of a shape."""
        start = shot.frame_range.start
        film = shot.film.settings(camera_path, start)
        path = camera_path or shot.default_camera().path
        own = read_camera(shot.stage, str(path), start)
        squeeze = own.lens.squeeze
        gate = Gate(own.horizontal_aperture_mm / squeeze, own.vertical_aperture_mm, squeeze, film["resolution"])
        frame = framing_guide(gate, aspect)
        exposed = frame.width_mm, frame.height_mm
        kind: Literal["film", "digital"] = "digital" if film["process"] == "digital" else "film"
        shot.camera.mount_body(camera_path, LibraryBody("", film["body"], "", kind, exposed, frame.resolution, squeeze))
        print_message(f"crop: {exposed[0]:.4g} × {exposed[1]:.4g} mm of {gate.width_mm:.4g} × {gate.height_mm:.4g} mm")

    def _set_shutter(self, shot: Shot, camera_path: str | None, shutter: ShutterTime) -> None:
        """Set the time at which the shutter closes, and the exposure time where the shot authors it."""
        start, rate = shot.frame_range.start, shot.stage.GetTimeCodesPerSecond()
        seconds = shutter.seconds(shot.stage.GetFramesPerSecond())
        exposure = shot.exposure.settings(camera_path, start)
        timed = {"exposure_time_s": seconds} if exposure["exposure_time_s"] != ExposureSettings.time_s else {}
        opens = exposure["shutter_open"]
        shot.exposure.set(camera_path, shutter_open=opens, shutter_close=opens + seconds * rate, **timed)

    def draw_guides(self, graded: FloatArray, camera: Camera) -> FloatArray:
        """Draw the guides over a graded picture; it is an `Overlay`.

        Args:
            graded: ``(height, width, 3)``.
            camera: of the picture.
        """
        if not self.guides:
            return graded
        from render.drawing.guides import draw_guides  # imports matplotlib, which takes a second

        return draw_guides(graded, camera, self.guides)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `read_camera_options`."""
    group = parser.add_argument_group("the camera, for this run alone")
    group.add_argument("--body", metavar="NAME", help="another camera body (pullfocus bodies): its gate, not its lens")
    group.add_argument("--crop", metavar="SHAPE", help="expose the middle of the gate alone, such as 2.39:1")
    group.add_argument("--stop", type=float, metavar="N", help="f-number of the iris; 0 is a pinhole")
    group.add_argument(
        "--shutter",
        metavar="ANGLE|TIME",
        help="time that the shutter is open: 172.8deg, 1/50 or 0.02 seconds; it sets exposure:time too where the shot does",
    )
    add_settings(group)
    group.add_argument(
        "--compensation", type=float, metavar="STOPS", help="stops of brightening; with a meter, on top of its reading"
    )
    group.add_argument(
        "--metering",
        metavar="MODE",
        help="metering mode: manual (no meter), center, average, spot, spot:NAME of a focus point, or spot:X,Y; see"
        " pullfocus meter",
    )
    group.add_argument(
        "--guides",
        metavar="LIST",
        help="draw frames over graded pictures: shapes such as 2.39:1,1.85:1, and safe, thirds, center",
    )


def read_camera_options(arguments: argparse.Namespace) -> CameraOptions:
    """Read the options.

    Args:
        arguments: as `add_arguments` declares them, and ``out``.

    Raises:
        SettingsError: the library has no such body, there is no such guide, or it cannot be drawn on such a file.
    """
    settings = read_settings(arguments)
    settings |= {} if arguments.metering is None else _read_metering(arguments.metering)
    return CameraOptions(
        body=_read_body(arguments.body),
        crop=None if arguments.crop is None else shape(arguments.crop),
        f_stop=arguments.stop,
        shutter=None if arguments.shutter is None else _read_shutter(arguments.shutter),
        settings=settings,
        compensation_stops=shared.check_compensation(arguments.compensation),
        guides=_read_guides(arguments),
    )


def _read_body(name: str | None) -> LibraryBody | None:
    try:
        return None if name is None else library_body(name)
    except SchemaError as error:
        raise SettingsError(f"--body: {error}", code="unknown_body") from error


def _read_metering(typed: str) -> dict[str, Any]:
    """Read metering settings, by the names of `EXPOSURE_SETTINGS`."""
    mode, _, spot = typed.partition(":")
    if mode not in METERING or (spot and mode != "spot"):
        known = f"{', '.join(METERING)}, spot:NAME or spot:X,Y"
        raise SettingsError(f"--metering takes {known}, got {typed!r}: {hint(mode, METERING)}")
    if not spot:
        return {"metering_mode": mode}
    if "," in spot:
        return {
            "metering_mode": mode,
            "metering_focus_point": "",
            "metering_spot": shared.read_place("--metering spot:", spot),
        }
    return {"metering_mode": mode, "metering_focus_point": spot}


def _read_guides(arguments: argparse.Namespace) -> tuple[Guide, ...]:
    if arguments.guides is None:
        return ()
    is_movie = movie_format_of(arguments.out) is not None
    if not is_movie and not arguments.contact_sheet and format_of(arguments.out) == "exr":
        raise SettingsError(f"--guides are drawn on graded pictures (.png, .jpg) and movies, got {arguments.out}")
    from render.drawing.guides import parse_guides  # imports matplotlib, which takes a second

    names = shared.split_words(arguments.guides)
    if not names:
        raise SettingsError(f"--guides takes shapes such as 2.39:1, and safe, thirds, center, got {arguments.guides!r}")
    return parse_guides(names)


def _read_shutter(typed: str) -> ShutterTime:
    """Read an angle in degrees, or seconds."""
    number = typed.strip().removesuffix("°").removesuffix("deg")
    if number == typed.strip():
        return ShutterTime(time_s=read_seconds("--shutter", typed))
    try:
        degrees = float(number)
    except ValueError:
        degrees = math.nan
    if not 0 < degrees <= 360:
        raise SettingsError(f"--shutter takes an angle above 0 and up to 360 degrees, got {typed!r}")
    return ShutterTime(angle_rad=math.radians(degrees))
