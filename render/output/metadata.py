"""Metadata of a frame's file: the camera, the time, and the settings of the render."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np

from render.film import FilmSettings, Grade
from render.model.arrays import DoubleArray
from render.model.camera import Camera
from render.model.framing import WHOLE, Framing
from render.optics.view import PinholeView

SOFTWARE = "Pullfocus"

Setting = str | int | float | tuple[str, ...]
# A name, OpenImageIO's word for the type, and the value.
Attribute = tuple[str, str, str | int | float | tuple[float, ...] | tuple[int, int]]


@dataclass(frozen=True, eq=False)
class FrameMetadata:
    """Everything about a frame that is not in its pixels.

    Attributes:
        camera: as the frame was rendered, focus solved in.
        time: USD time code of the frame; NaN for the default time, which has no number.
        frames_per_second: of the shot.
        time_codes_per_second: of the shot; movies show a frame at each time code.
        grade: grade of the picture; its working space is that of the radiance.
        film: film that the picture was developed on; None for none.
        settings: settings of the render (``dataclasses.asdict`` of the frame's settings); each becomes
            ``pullfocus:<name>``.
        stage: the shot's name.
        prim_paths: paths that the ids of the ``prim_id`` AOV index: ``Scene.prim_paths``.
        exposure_time_s: UsdGeomCamera's ``exposure:time`` where it is authored.
        iso: UsdGeomCamera's ``exposure:iso`` where it is authored.
        matte_names: names in the picture of each matte among its AOVs.
        view: eye that the frame is for, as OpenEXR's standard attribute ``view``; empty for none.
        color_space: linear colour space that colours are written in; empty for the working space.
        metres_per_unit: of the stage's units.
        t_stop: of the lens, where it is marked in T-stops or its glass takes light; None where its f-number says all.
    """

    camera: Camera
    time: float = 0.0
    frames_per_second: float = 24.0
    time_codes_per_second: float = 24.0
    grade: Grade = field(default_factory=Grade)
    film: FilmSettings | None = None
    settings: Mapping[str, Setting] = field(default_factory=dict)
    stage: str = ""
    prim_paths: tuple[str, ...] = ()
    exposure_time_s: float | None = None
    iso: float | None = None
    matte_names: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    view: str = ""
    color_space: str = ""
    metres_per_unit: float = 1.0
    t_stop: float | None = None

    @property
    def description(self) -> str:
        """One line for people: shot, camera and time."""
        when = "default time" if math.isnan(self.time) else f"frame {self.time:g}"
        return " ".join(part for part in (self.stage, self.camera.path, when) if part)

    def exr_attributes(self, width: int, height: int, framing: Framing = WHOLE) -> list[Attribute]:
        """Attributes for the header of an EXR part.

        Names, types and units are those of OpenEXR's "Standard Attributes"; what that list has no name for is called
        ``pullfocus:*``. World space is metres with +Y up, and the matrices are for row vectors, as in Imath. Frustum and sensor
        are those of the whole picture, which is the display window.

        Args:
            width: of the picture in pixels.
            height: of the picture in pixels.
            framing: place of the picture in the whole one.

        Raises:
            CameraError: the camera makes no picture.
        """
        camera, *size = framing.uncut(self.camera, width, height)
        view = PinholeView.from_camera(camera, *size)
        picture = [*self._shot_attributes(), *_grade_attributes(self.grade), *_film_attributes(self.film)]
        return [*picture, *_view_attributes(camera, view), *_lens_attributes(camera, view), *self._light_attributes()]

    def _shot_attributes(self) -> list[Attribute]:
        named: list[Attribute] = [
            ("Software", "string", SOFTWARE),
            ("comments", "string", self.description),
            ("framesPerSecond", "rational", exact_frame_rate(self.frames_per_second)),
            ("pullfocus:exposureScale", "float", self.camera.exposure_scale),
            ("pullfocus:worldSpace", "string", "metres, +Y up"),
        ]
        if not math.isnan(self.time):
            named += [("imageCounter", "int", math.floor(self.time)), ("pullfocus:timeCode", "float", self.time)]
        if self.view:
            named.append(("view", "string", self.view))
        if self.stage:
            named.append(("pullfocus:stage", "string", self.stage))
        if self.camera.path:
            named.append(("cameraLabel", "string", self.camera.path))
        return named + [_setting_attribute(name, value) for name, value in self.settings.items()]

    def _light_attributes(self) -> list[Attribute]:
        named: list[Attribute] = []
        if self.exposure_time_s is not None:
            named.append(("expTime", "float", self.exposure_time_s))
        if self.iso is not None:
            named.append(("isoSpeed", "float", self.iso))
        return named

    def exif_attributes(self) -> list[Attribute]:
        """The lens as photographs carry it (Exif 2.3), for PNG and JPEG."""
        camera = self.camera
        named: list[Attribute] = []
        if camera.orthographic is None:
            named.append(("Exif:FocalLength", "float", camera.focal_length_mm))
        if camera.f_stop > 0:
            named.append(("FNumber", "float", camera.f_stop))
        if math.isfinite(camera.stated_focus_m):
            named.append(("Exif:SubjectDistance", "float", camera.stated_focus_m))
        return named


def exact_frame_rate(frames_per_second: float) -> tuple[int, int]:
    """A frame rate as numerator and denominator; 23.976 and its kin become the exact n·1000/1001.

    Args:
        frames_per_second: more than 0.
    """
    whole = round(frames_per_second)
    if (
        abs(frames_per_second - whole) > 1e-6
        and abs(frames_per_second * 1.001 - round(frames_per_second * 1.001)) < 1e-3
    ):
        return round(frames_per_second * 1.001) * 1000, 1001
    rate = Fraction(frames_per_second).limit_denominator(1000)
    return rate.numerator, rate.denominator


def _grade_attributes(grade: Grade) -> list[Attribute]:
    """Attributes with the intended grade: an EXR holds ungraded light, and a viewer can apply it."""
    if grade.space is not None:
        return [("pullfocus:pictureSpace", "string", grade.space)]
    named: list[Attribute] = [
        ("pullfocus:display", "string", grade.display_name),
        ("pullfocus:view", "string", grade.view_name),
    ]
    if grade.config:
        named.append(("pullfocus:colorConfig", "string", str(grade.config)))
    if grade.look:
        named.append(("pullfocus:look", "string", grade.look))
    if not grade.cdl.is_neutral:
        named += [
            (f"pullfocus:cdl{name}", "float[3]", numbers)
            for name, numbers in (("Slope", grade.cdl.slope), ("Offset", grade.cdl.offset), ("Power", grade.cdl.power))
        ]
        named.append(("pullfocus:cdlSaturation", "float", grade.cdl.saturation))
    return named


def _film_attributes(film: FilmSettings | None) -> list[Attribute]:
    """Attributes with the film that the picture was developed on; the light in the file is from before that."""
    if film is None:
        return []
    named: list[Attribute] = [("pullfocus:filmProcess", "string", film.process)]
    stocks = (("filmStock", film.stock), ("filmPrint", film.print_stock))
    named += [(f"pullfocus:{key}", "string", stock.name) for key, stock in stocks if stock is not None]
    return named + ([("pullfocus:filmPush", "float", film.push)] if film.push else [])


def _lens_attributes(camera: Camera, view: PinholeView) -> list[Attribute]:
    """Attributes of the lens and the shutter."""
    image_distance_mm = view.fx / view.width * camera.horizontal_aperture_mm
    named: list[Attribute] = [("focus", "float", camera.stated_focus_m)]
    if camera.orthographic is None:
        named += [
            ("nominalFocalLength", "float", camera.focal_length_mm),
            ("effectiveFocalLength", "float", camera.focal_length_mm),
            ("pinholeFocalLength", "float", image_distance_mm),
        ]
    # OpenEXR wants a positive f-number, so a pinhole has none.
    if camera.f_stop > 0:
        named.append(("aperture", "float", camera.f_stop))
    if camera.shutter_close > camera.shutter_open:
        named.append(("shutterAngle", "float", 360.0 * (camera.shutter_close - camera.shutter_open)))
    return named


def _view_attributes(camera: Camera, view: PinholeView) -> list[Attribute]:
    """Attributes of the camera's pose and frustum; the screen window of an orthographic camera is that at all distances."""
    at_m = 1.0 if camera.orthographic is None else camera.focal_length_mm / 1000
    own_from_world = view.camera_from_world.copy()
    own_from_world[2, 3] += camera.set_back_m
    return [
        ("worldToCamera", "matrix", _row_vector_matrix(np.diag([1.0, 1.0, -1.0, 1.0]) @ own_from_world)),
        ("worldToNDC", "matrix", _row_vector_matrix(_picture_from_camera(view) @ view.camera_from_world)),
        ("screenWindowWidth", "float", at_m * view.width / view.fx),
        (
            "screenWindowCenter",
            "float[2]",
            (at_m * (view.width / 2 - view.cx) / view.fx, at_m * (view.cy - view.height / 2) / view.fy),
        ),
        ("sensorOverallDimensions", "float[2]", (camera.horizontal_aperture_mm, camera.vertical_aperture_mm)),
        # Microns; positive values show more to the right and *below*.
        ("sensorCenterOffset", "float[2]", (1000 * camera.horizontal_offset_mm, -1000 * camera.vertical_offset_mm)),
    ]


def _picture_from_camera(view: PinholeView) -> DoubleArray:
    """``(4, 4)`` OpenEXR's normalised device coordinates from camera space: (0, 0) top left to (1, 1) bottom right.

    Depth runs from 0 at the near plane to 1 at the far one.
    """
    stretch = 1.0 if math.isinf(view.far_m) else view.far_m / (view.far_m - view.near_m)
    return np.array(
        [
            [view.fx / view.width, 0, -view.cx / view.width, 0],
            [0, -view.fy / view.height, -view.cy / view.height, 0],
            [0, 0, -stretch, -stretch * view.near_m],
            [0, 0, -1, 0],
        ]
    )


def _row_vector_matrix(matrix: DoubleArray) -> tuple[float, ...]:
    """The 16 numbers of a column-vector matrix in the order of an Imath matrix."""
    return tuple(matrix.T.ravel().tolist())


def _setting_attribute(name: str, value: Setting) -> Attribute:
    key = f"pullfocus:{name}"
    if isinstance(value, int | float):
        return (key, "int" if isinstance(value, int) else "float", value)
    return (key, "string", value if isinstance(value, str) else ",".join(value))
