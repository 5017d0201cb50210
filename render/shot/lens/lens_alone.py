"""A lens on a default camera, to be measured and drawn."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from render.errors import SettingsError
from render.model.camera import Camera
from render.model.lens import IrisShape, Lens
from render.optics.lens_files import MeasuredLens, is_data_sheet, read_lens_file, read_measured_lens
from render.optics.prescription.completion import complete_prescription
from render.optics.prescription.mounting import PRESCRIBED
from render.optics.prescription.paraxial import first_order
from render.optics.prescription.zooming import marked_close_focus_m, set_focal_length, zoom_of
from render.shot.lens.lens_choice import is_lens_file, library_entry
from render.stage.camera.lens_data import nominal_squeeze
from render.stage.camera.lenses import make_iris, make_lens
from usd_schemas import LibraryLens

FULL_FRAME_MM = (36.0, 24.0)
DEFAULT_F_STOP = 2.8
"""F-number of a lens whose data sheet has none."""
_NEAREST_M, _FARTHEST_M = 1e-6, 1e9
"""Nearer counts as 0, farther as infinity."""


@dataclass(frozen=True, eq=False)
class LensAlone:
    """A lens of the library or of a file.

    Attributes:
        name: in the library, or the file name without its suffix.
        title: engraved on the lens.
        description: one line; empty for a lens of a file.
        f_stop: wide open; 0 for a pinhole.
        camera: full frame, with the lens wide open and focused at infinity.
        source: whence its numbers are, with the year and what is stated there; empty for a lens of a file.
    """

    name: str
    title: str
    description: str
    f_stop: float
    camera: Camera
    source: str = ""

    def set_to(
        self,
        f_stop: float | None,
        focus_distance_m: float | None,
        gate_mm: tuple[float, float],
        *,
        focal_length_mm: float | None = None,
    ) -> Camera:
        """Return the camera at another setting of the lens.

        Args:
            f_stop: None leaves it wide open.
            focus_distance_m: None keeps infinity.
            gate_mm: width and height of the film gate.
            focal_length_mm: of a zoom; None keeps the one it was read at.

        Raises:
            SettingsError: a number is out of range, an f-number is given for a pinhole, or a focal length for a lens that does
                not zoom to it.
            InputError: the prescription is no lens.
        """
        if focal_length_mm is not None:
            return self._zoomed(focal_length_mm).set_to(f_stop, focus_distance_m, gate_mm)
        if f_stop is not None and not 0 < f_stop < math.inf:
            raise SettingsError(f"an f-number must be above 0, got {f_stop:g}")
        if f_stop is not None and self.f_stop == 0:
            raise SettingsError(f"{self.title} is a pinhole: it has no f-number to set, got {f_stop:g}")
        distance_m = math.inf if focus_distance_m is None else focus_distance_m
        if not distance_m >= _NEAREST_M:
            raise SettingsError(f"a focus distance must be above 0 m, got {distance_m:g}")
        if not all(0.1 <= side <= 1000 for side in gate_mm):
            raise SettingsError(f"a film gate's sides must be from 0.1 to 1000 mm, got {gate_mm[0]:g} x {gate_mm[1]:g}")
        return replace(
            self.camera,
            f_stop=self.camera.f_stop if f_stop is None else f_stop,
            focus_distance_m=distance_m if distance_m <= _FARTHEST_M else math.inf,
            horizontal_aperture_mm=gate_mm[0],
            vertical_aperture_mm=gate_mm[1],
        )

    @property
    def is_zoom(self) -> bool:
        """Whether it has more than one focal length.

        Raises:
            InputError: no lens has such configurations.
        """
        prescription = self.camera.lens.prescription
        return prescription is not None and zoom_of(prescription) is not None

    def _zoomed(self, focal_length_mm: float) -> LensAlone:
        """The lens at another focal length, wide open."""
        prescription = self.camera.lens.prescription
        zoom = zoom_of(prescription) if prescription is not None else None
        if zoom is None or prescription is None:
            raise SettingsError(f"{self.title} is no zoom: its focal length is {self.camera.focal_length_mm:.4g} mm")
        if not zoom.holds(focal_length_mm):
            span = f"from {zoom.shortest_mm:.4g} to {zoom.longest_mm:.4g} mm"
            raise SettingsError(f"{self.title} zooms {span}, got {focal_length_mm:g} mm", code="zoom_range")
        whole = complete_prescription(set_focal_length(prescription, focal_length_mm))
        camera = replace(self.camera, focal_length_mm=focal_length_mm, f_stop=whole.f_stop)
        return replace(self, camera=camera, f_stop=whole.f_stop)


def lens_alone(name_or_file: str, allow_unknown_glass: bool = False) -> LensAlone:
    """Read a lens: a file where the name has a lens file's suffix or a folder, else a lens of the library.

    Args:
        name_or_file: the lens.
        allow_unknown_glass: take a file's glass that no catalogue has by the index and the Abbe number beside its name.

    Raises:
        NotFoundError: the library has no such lens; the message has the nearest names.
        InputError: the file cannot be read, or has no usable lens.
    """
    if not is_lens_file(name_or_file):
        return library_lens_alone(name_or_file)
    if is_data_sheet(name_or_file):
        return _from_data_sheet(Path(name_or_file).stem, read_measured_lens(name_or_file))
    prescription = read_lens_file(name_or_file, allow_unknown_glass)
    marked_m = marked_close_focus_m(prescription)
    squeeze = nominal_squeeze(prescription)
    lens = Lens("prescription", prescription.name, prescription, squeeze=squeeze, close_focus_m=marked_m)
    return _mount_alone(Path(name_or_file).stem, prescription.name, "", lens, IrisShape())


def _from_data_sheet(name: str, measured: MeasuredLens) -> LensAlone:
    wide_open = measured.f_stops[0] or measured.sheet.f_stop or DEFAULT_F_STOP
    lens = Lens("dataSheet", measured.name, data_sheet=measured.sheet, close_focus_m=measured.close_focus_m)
    return _mount_alone(
        name,
        measured.name,
        " ".join(measured.sources),
        lens,
        IrisShape(),
        focal_length_mm=measured.focal_length_mm,
        f_stop=wide_open,
    )


def library_lens_alone(name: str) -> LensAlone:
    """Read a lens of the library.

    Raises:
        NotFoundError: the library has no such lens; the message has the nearest names.
    """
    entry = library_entry(name)
    iris = make_iris(entry.aperture, entry.name) if entry.aperture else IrisShape()
    lens = make_lens(entry.lens, entry.name)
    return _mount_alone(
        entry.name,
        entry.lens.name,
        entry.description,
        lens,
        iris,
        focal_length_mm=entry.focal_length_mm,
        f_stop=entry.f_stop,
        source=_source(entry),
    )


def _source(entry: LibraryLens) -> str:
    parts = [entry.source, str(entry.year or "")]
    if (stated := entry.stated) is not None:
        field = f" over {stated.field_deg:g}°" if stated.field_deg else ""
        parts.append(f"stated there {stated.focal_length_mm:g} mm f/{stated.f_stop:g}{field}")
    return "; ".join(part for part in parts if part)


def _mount_alone(
    name: str,
    title: str,
    description: str,
    lens: Lens,
    iris: IrisShape,
    *,
    focal_length_mm: float = 0.0,
    f_stop: float = 0.0,
    source: str = "",
) -> LensAlone:
    """Mount a lens on a camera; focal length and f-number of a prescription are computed from its surfaces."""
    if lens.model in PRESCRIBED and lens.prescription is not None:
        whole = complete_prescription(lens.prescription)
        focal_length_mm, f_stop = first_order(whole).focal_length_mm, whole.f_stop
    camera = Camera(
        np.eye(4),
        focal_length_mm=focal_length_mm,
        horizontal_aperture_mm=FULL_FRAME_MM[0],
        vertical_aperture_mm=FULL_FRAME_MM[1],
        f_stop=f_stop,
        focus_distance_m=math.inf,
        iris=iris,
        lens=lens,
        path=title,
    )
    return LensAlone(name, title, description, f_stop, camera, source)
