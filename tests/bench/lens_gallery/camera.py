"""The whole camera on the demo shot: stocks, stops, lenses, motion and long exposures, each as `pullfocus record` makes it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from pxr import Usd, UsdGeom

from render.model.shutter_intervals import ShutterInterval
from render.shot import Shot
from render.shot.lens.lens_choice import choose_lens
from tests.bench.lens_gallery.entries import Section

FRAME = 72.0
"""The far robot waves, and is in focus."""
_FAR, _LIGHTS = (0.6, 0.26), (0.4, 0.13)


@dataclass(frozen=True, eq=False)
class CameraEntry:
    """One picture with a detail of it, which the shot's camera takes.

    Attributes:
        slug: its files' name.
        title: heading.
        note: what to look at.
        stock: of the library; empty for the shot's own way.
        lens: of the library; empty for the shot's own.
        f_stop: 0 for the shot's own.
        exposure: other exposure settings of the camera, by the names of `EXPOSURE_SETTINGS`.
        motion: moments of the shutter's opening.
        finer: times the rays of other pictures, where each place is exposed in few of the moments.
        opening: of a long exposure; None for a frame.
        nd_stops: of its filter; None for one that keeps the exposure.
        tripod: whether the camera stands still.
        detail: centre of the enlarged detail, in shares of the picture's width and height from its upper left corner.
    """

    slug: str
    title: str
    note: str
    stock: str = ""
    lens: str = ""
    f_stop: float = 0.0
    exposure: Mapping[str, Any] = field(default_factory=dict)
    motion: int = 1
    finer: int = 1
    opening: ShutterInterval | None = None
    nd_stops: float | None = None
    tripod: bool = False
    detail: tuple[float, float] = _FAR

    @property
    def frame(self) -> float:
        """At which the picture begins."""
        return FRAME if self.opening is None else self.opening.first

    def prepare(self, shot: Shot) -> None:
        """Set the shot's camera for it."""
        if self.lens:
            shot.camera.mount_lens(None, choose_lens(self.lens))
        if self.f_stop:
            shot.camera.set(None, f_stop=self.f_stop)
        if self.exposure:
            shot.exposure.set(None, **self.exposure)
        if self.tripod:
            _stand_still(shot, self.frame)


def _stand_still(shot: Shot, time: float) -> None:
    """Leave the camera where it is at a time."""
    with shot.edits.transaction("put the camera on a tripod"):
        camera = UsdGeom.Xformable(shot.stage.GetPrimAtPath(shot.default_camera().path))
        place = camera.GetLocalTransformation(Usd.TimeCode(time))
        camera.MakeMatrixXform().Set(place)


def camera_sections() -> tuple[Section, ...]:
    """Return the sections that a cinematographer compares first."""
    return (_stocks(), _stops(), _lenses(), _motion(), _long_exposures())


def _stocks() -> Section:
    def on(stock: str, title: str, note: str) -> CameraEntry:
        return CameraEntry(f"stock-{stock}", title, note, stock=stock)

    return Section(
        "Three stocks",
        "The same light on three films: a negative on its print, a reversal film, and black and white on its print.",
        (
            CameraEntry("stock-none", "No film", "What the display's own view makes of the light."),
            on("vision3_500t_5219", "Kodak Vision3 500T 5219", "A fast negative for 3200 K, printed on Vision 2383."),
            on("velvia_50", "Fuji Velvia 50", "Steep and saturated: lights burn out, shadows close."),
            on("tri_x_400", "Kodak Tri-X 400", "Black and white, with its grain."),
        ),
    )


def _stops() -> Section:
    def at(f_stop: float, note: str) -> CameraEntry:
        return CameraEntry(f"stop-{f_stop:g}", f"f/{f_stop:g}", note, f_stop=f_stop, lens="planar_50", detail=_LIGHTS)

    darker = {"exposure_stop": "iris", "compensation_stops": 1.0}
    return Section(
        "Three stops",
        "The Planar's depth of field, exposed alike; and as it is where the iris alone is turned.",
        (
            at(1.4, "Wide open: the string lights are disks, cut by the barrel in the corners."),
            at(2.8, "Two stops down."),
            at(5.6, "Four stops down: all but the near robot is sharp."),
            CameraEntry(
                "stop-2.8-iris",
                "f/2.8, exposed by the iris",
                "Two stops darker than wide open at the same time and ISO.",
                f_stop=2.8,
                lens="planar_50",
                exposure=darker,
                detail=_LIGHTS,
            ),
        ),
    )


def _lenses() -> Section:
    def through(lens: str, title: str, note: str) -> CameraEntry:
        return CameraEntry(f"lens-{lens}", title, note, lens=lens, stock="vision3_500t_5219", detail=_LIGHTS)

    return Section(
        "Three lenses",
        "Wide open on 5219, from the same place, focused on the far robot.",
        (
            through("planar_50", "Planar 50/1.4", "By its prescription: cat's eyes toward the corners."),
            through("distagon_35", "Distagon 35/1.4", "Wider: more of the street, smaller disks."),
            through("swirly_58", "A Petzval lens, 58 mm f/2", "The field curves: what is out of focus swirls."),
        ),
    )


def _motion() -> Section:
    def moving(
        slug: str, title: str, note: str, *, motion: int = 12, finer: int = 1, **exposure: object
    ) -> CameraEntry:
        return CameraEntry(f"motion-{slug}", title, note, motion=motion, finer=finer, exposure=exposure)

    return Section(
        "Motion",
        "The far robot waves while the camera moves in. Motion blur and depth of field are one integral over the shutter's "
        "opening.",
        (
            moving("still", "Stopped", "One moment.", motion=1),
            moving("180", "A shutter of 180°", "The shot's own: half of each frame."),
            moving(
                "slow",
                "A quarter of a second",
                "Six frames: who waves is a blur.",
                shutter_open=-3.0,
                shutter_close=3.0,
            ),
            moving(
                "rolling",
                "A slow rolling shutter",
                "Read from top to bottom over six frames: what moves leans, and is sharp in each line.",
                finer=4,
                shutter_open=-3.0,
                shutter_close=-2.5,
                shutter_type="rolling",
                shutter_travel_s=6 / 24,
            ),
        ),
    )


def _long_exposures() -> Section:
    def long(slug: str, title: str, note: str, opening: ShutterInterval, **rest: object) -> CameraEntry:
        make: Callable[..., CameraEntry] = CameraEntry
        return make(f"long-{slug}", title, note, opening=opening, **rest)

    return Section(
        "Long exposures",
        "One picture while the shot goes on: the mean of all its light, as with a neutral density filter that keeps the "
        "exposure.",
        (
            CameraEntry("long-none", "One frame", "Frame 72, stopped: to hold the others against."),
            long(
                "hand",
                "A second by hand",
                "The camera moves in: every light leaves its trail.",
                ShutterInterval(64, 88, 2),
            ),
            long(
                "tripod",
                "A second on a tripod",
                "What stands still is sharp and as bright as in one frame; who moves fades.",
                ShutterInterval(64, 88, 2),
                tripod=True,
            ),
            long(
                "no-filter",
                "Without a filter",
                "Two frames on a tripod with no filter: two stops brighter than one frame at 180°.",
                ShutterInterval(72, 74, 1),
                tripod=True,
                nd_stops=0.0,
            ),
        ),
    )
