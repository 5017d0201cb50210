"""Options of `pullfocus record` that set the camera for one run: its body, stop, exposure and light meter; and framing guides."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from render.cli import arguments as shared
from render.cli.report import say
from render.cli.setting_options import add_settings, seconds, typed_settings
from render.errors import SettingsError
from render.model.arrays import FloatArray
from render.model.camera import Camera
from render.near_names import hint
from render.optics.framing import Gate, framing_guide, shape
from render.optics.photometry.exposure import ExposureSettings, shutter_time_s
from render.output import format_of
from render.shot import Shot
from render.stage import read_camera
from usd_schemas import LibraryBody, SchemaError, library_body
from usd_schemas.settings.tables import EXPOSURE_SETTINGS, FILM_SETTINGS

if TYPE_CHECKING:  # matplotlib takes a second, and few ask for guides
    from render.drawing.guides import Guide

Viewed = Callable[[FloatArray, Camera], FloatArray]
"""A graded picture and the camera that took it, to the picture as it is looked at."""
METERING = EXPOSURE_SETTINGS["metering_mode"].choices


@dataclass(frozen=True)
class ShutterTime:
    """How long a shutter is open.

    Attributes:
        angle_rad: of a rotating shutter; 0 where it is said in seconds.
        time_s: in seconds; 0 where it is said as an angle.
    """

    angle_rad: float = 0.0
    time_s: float = 0.0

    def seconds(self, frames_per_second: float) -> float:
        """How long that is at a frame rate.

        Raises:
            SettingsError: the angle is more than a full turn.
        """
        return shutter_time_s(self.angle_rad, frames_per_second) if self.angle_rad else self.time_s


@dataclass(frozen=True)
class AskedCamera:
    """What is asked of the camera for one run.

    Attributes:
        body: of the library; None keeps the shot's.
        crop: width over height of the part of the gate that is exposed, in its middle; None is all of it.
        f_stop: of the iris; None keeps the shot's.
        shutter: how long it is open; None keeps the shot's.
        settings: of exposure and film, by their names.
        compensation_stops: by how much brighter, than it is set to or than the meter says; None keeps the shot's.
        guides: drawn over graded pictures.
    """

    body: LibraryBody | None = None
    crop: float | None = None
    f_stop: float | None = None
    shutter: ShutterTime | None = None
    settings: dict[str, Any] = field(default_factory=dict)
    compensation_stops: float | None = None
    guides: tuple[Guide, ...] = ()

    def set_on(self, shot: Shot, camera: str | None) -> None:
        """Set the camera for this run alone, and say what that changed.

        Args:
            shot: the shot.
            camera: prim path; None for a camera that frames the whole stage.

        Raises:
            InputError: there is no camera to set.
            SettingsError: a value is out of range.
        """
        if self.body is not None:
            shot.camera.mount_body(camera, self.body)
            width, height = self.body.gate_mm
            say(f"body: {self.body.title} (gate {width:g} × {height:g} mm)")
        if self.crop is not None:
            self._crop(shot, camera, self.crop)
        if self.f_stop is not None:
            shot.camera.set(camera, f_stop=self.f_stop)
        if self.shutter is not None:
            self._open_shutter(shot, camera, self.shutter)
        exposure = {name: value for name, value in self.settings.items() if name in EXPOSURE_SETTINGS}
        film = {name: value for name, value in self.settings.items() if name in FILM_SETTINGS}
        if exposure:
            shot.exposure.set(camera, **exposure)
        if film:
            shot.film.set(camera, **film)
        if self.compensation_stops is not None:
            is_metered = shot.exposure.settings(camera, shot.frame_range.start)["metering_mode"] != "manual"
            name = "metering_compensation_stops" if is_metered else "compensation_stops"
            shot.exposure.set(camera, **{name: self.compensation_stops})

    def _crop(self, shot: Shot, camera: str | None, aspect: float) -> None:
        """Expose no more of the gate, and of its photosites, than the largest frame of a shape in its middle."""
        start = shot.frame_range.start
        said = shot.film.settings(camera, start)
        path = camera or shot.default_camera().path
        own = read_camera(shot.stage, str(path), start)
        squeeze = own.lens.squeeze
        gate = Gate(own.horizontal_aperture_mm / squeeze, own.vertical_aperture_mm, squeeze, said["resolution"])
        frame = framing_guide(gate, aspect)
        exposed = frame.width_mm, frame.height_mm
        kind: Literal["film", "digital"] = "digital" if said["process"] == "digital" else "film"
        shot.camera.mount_body(camera, LibraryBody("", said["body"], "", kind, exposed, frame.resolution, squeeze))
        say(f"crop: {exposed[0]:.4g} × {exposed[1]:.4g} mm of {gate.width_mm:.4g} × {gate.height_mm:.4g} mm")

    def _open_shutter(self, shot: Shot, camera: str | None, opening: ShutterTime) -> None:
        """Close the shutter later or earlier. A shot that says how long it exposes does so for as long."""
        start, rate = shot.frame_range.start, shot.stage.GetTimeCodesPerSecond()
        seconds = opening.seconds(shot.stage.GetFramesPerSecond())
        said = shot.exposure.settings(camera, start)
        timed = {"exposure_time_s": seconds} if said["exposure_time_s"] != ExposureSettings.time_s else {}
        opens = said["shutter_open"]
        shot.exposure.set(camera, shutter_open=opens, shutter_close=opens + seconds * rate, **timed)

    def viewed(self, graded: FloatArray, camera: Camera) -> FloatArray:
        """A graded picture as it is looked at: with the guides over it.

        Args:
            graded: ``(height, width, 3)``.
            camera: that took it.
        """
        if not self.guides:
            return graded
        from render.drawing.guides import with_guides  # imports matplotlib, which takes a second

        return with_guides(graded, camera, self.guides)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options, for `asked_camera`."""
    group = parser.add_argument_group("the camera, for this run alone")
    group.add_argument("--body", metavar="NAME", help="another camera body (pullfocus bodies): its gate, not its lens")
    group.add_argument("--crop", metavar="SHAPE", help="expose the middle of the gate alone, such as 2.39:1")
    group.add_argument("--stop", type=float, metavar="N", help="f-number of the iris; 0 is a pinhole")
    group.add_argument(
        "--shutter",
        metavar="ANGLE|TIME",
        help="how long the shutter is open: 172.8deg, 1/50 or 0.02 seconds; a shot that sets exposure:time is exposed as long",
    )
    add_settings(group)
    group.add_argument(
        "--compensation", type=float, metavar="STOPS", help="brighter by so much; with a meter, than it says"
    )
    group.add_argument(
        "--metering",
        metavar="MODE",
        help="expose by a light meter, or not: manual, center, average, spot, spot:NAME of a focus point, or spot:X,Y; see"
        " pullfocus meter",
    )
    group.add_argument(
        "--guides",
        metavar="LIST",
        help="draw frames over graded pictures: shapes such as 2.39:1,1.85:1, and safe, thirds, center",
    )


def asked_camera(arguments: argparse.Namespace) -> AskedCamera:
    """What the options ask for.

    Args:
        arguments: as `add_arguments` declares them, and ``out``.

    Raises:
        SettingsError: the library has no such body, there is no such guide, or it cannot be drawn on such a file.
    """
    asked = typed_settings(arguments)
    asked |= {} if arguments.metering is None else _metering(arguments.metering)
    return AskedCamera(
        body=_body(arguments.body),
        crop=None if arguments.crop is None else shape(arguments.crop),
        f_stop=arguments.stop,
        shutter=None if arguments.shutter is None else _opening(arguments.shutter),
        settings=asked,
        compensation_stops=shared.compensation(arguments.compensation),
        guides=_guides(arguments),
    )


def _body(name: str | None) -> LibraryBody | None:
    try:
        return None if name is None else library_body(name)
    except SchemaError as error:
        raise SettingsError(f"--body: {error}", code="unknown_body") from error


def _metering(typed: str) -> dict[str, Any]:
    """What is asked of the light meter, by the names that `EXPOSURE_SETTINGS` has."""
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
            "metering_spot": shared.place("--metering spot:", spot),
        }
    return {"metering_mode": mode, "metering_focus_point": spot}


def _guides(arguments: argparse.Namespace) -> tuple[Guide, ...]:
    if arguments.guides is None:
        return ()
    if not arguments.contact_sheet and format_of(arguments.out) == "exr":
        raise SettingsError(f"--guides are drawn on graded pictures (.png, .jpg), got {arguments.out}")
    from render.drawing.guides import guides_of  # imports matplotlib, which takes a second

    names = shared.split_words(arguments.guides)
    if not names:
        raise SettingsError(f"--guides takes shapes such as 2.39:1, and safe, thirds, center, got {arguments.guides!r}")
    return guides_of(names)


def _opening(typed: str) -> ShutterTime:
    """An angle in degrees, or seconds."""
    number = typed.strip().removesuffix("°").removesuffix("deg")
    if number == typed.strip():
        return ShutterTime(time_s=seconds("--shutter", typed))
    try:
        degrees = float(number)
    except ValueError:
        degrees = math.nan
    if not 0 < degrees <= 360:
        raise SettingsError(f"--shutter takes an angle above 0 and up to 360 degrees, got {typed!r}")
    return ShutterTime(angle_rad=math.radians(degrees))
