"""LensAPI: the glass in front of the film."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from usd_schemas.settings.lens_configurations import Configurations
from usd_schemas.settings.lens_errors import AberrationScales, DataSheet, HydraDistortion, Seidel, SplitDiopter
from usd_schemas.settings.prescription import HeightField, Prescription
from usd_schemas.settings.setting import (
    Bounds,
    Floats,
    Option,
    Pair,
    Range,
    Slider,
    Triple,
    group,
    schema_group,
    setting,
)

LensModel = Literal["pinhole", "thin", "seidel", "spherical", "heightField", "prescription", "dataSheet"]


@schema_group("Lens")
@dataclass(frozen=True)
class LensData:
    """LensAPI: the glass in front of the film."""

    model: LensModel = setting(
        "lens:model",
        "thin",
        "Model",
        "Model by which light passes the lens.",
        "- pinhole: everything is sharp, whatever fStop says.\n"
        "- thin: the ideal lens of focalLength and fStop.\n"
        "- seidel: the thin lens with the third-order wavefront errors of lens:seidel:*.\n"
        "- spherical: one thick element, the two surfaces of lens:prescription:*.\n"
        "- heightField: one thick element whose two surfaces of lens:prescription:* carry the heights of "
        "lens:heightField:*.\n"
        "- prescription: all surfaces of lens:prescription:*.\n"
        "- dataSheet: the thin lens with the measured errors of lens:table:*.",
        unit="none, a token",
        keyable=False,
    )
    name: str = setting(
        "lens:name",
        "",
        "Name",
        'The lens\'s name for people, and its name in a lens library, such as "Double Gauss 50 mm".',
        unit="none, text",
        keyable=False,
    )
    manufacturer: str = setting(
        "lens:manufacturer",
        "",
        "Manufacturer",
        "Who made the lens, as it is written to the `lensMake` of an OpenEXR file.",
        unit="none, text",
        keyable=False,
    )
    serial_number: str = setting(
        "lens:serialNumber",
        "",
        "Serial Number",
        "The serial number on the barrel of this very lens.",
        unit="none, text",
        keyable=False,
    )
    breathing: bool = setting(
        "lens:breathing",
        False,
        "Breathing",
        "Whether the field of view changes with focus, as the image distance of a real lens makes it, and with it "
        "the light that reaches the film (the bellows factor).",
        "False keeps the field of view that focalLength and the apertures say, and the light, as other USD "
        "renderers show them.",
        unit="none, a switch",
        rest="exposure",
    )
    circle_distance: Literal["focalLength", "imageDistance"] = setting(
        "lens:circleDistance",
        "focalLength",
        "Circle Distance",
        "Distance from lens to film by which circles of confusion, and with them depth of field, are computed.",
        "- focalLength: the focal length f, as in the picture, whose framing does not change with focus: f A |1/d - 1/s| "
        "for the pupil's diameter A, the point's depth d and the focus distance s.\n"
        "- imageDistance: the image distance v of the focused lens in place of f (Kyaw 2013, equation 5.3), as on the film "
        "of a real camera and in depth-of-field tables. Readouts, limits and stops follow; the picture does not change.\n"
        "A lens with lens:breathing has the image distance either way.",
        unit="none, a token",
        keyable=False,
        rest="exposure",
        option=Option("--circle-distance"),
    )
    transmittance: float = setting(
        "lens:transmittance",
        1.0,
        "Transmittance",
        "The part of the light that comes through the glass: the T-stop is fStop / sqrt(transmittance).",
        unit="none, a ratio from 0 to 1",
        hard=(0, 1),
        soft=(0.5, None),
        rest="exposure",
        slider=Slider(0, 1, 0.05, unit="%", label="Passes", panel="glass"),
    )
    neutral_density: float = setting(
        "lens:neutralDensity",
        0.0,
        "Neutral Density",
        "Optical density of the neutral filter in front: 0.3 takes about one stop.",
        unit="optical density, log10 of the attenuation",
        hard=(0, None),
        soft=(None, 3),
        rest="exposure",
        bounds=Bounds(0, 20),
        option=Option("--filter", "ND", Range(0, 12), "a density"),
        slider=Slider(0, 3, 0.3, zero="none", label="ND"),
    )
    stop_marking: Literal["f", "t"] = setting(
        "lens:stopMarking",
        "f",
        "Stop Marking",
        "Stops on the barrel: f-numbers, or T-stops, which have in them what the glass takes.",
        "- f: f-numbers, as on lenses for photography: what lens:transmittance takes darkens the picture.\n"
        "- t: T-stops, as on lenses for the cinema: exposure:fStop, or fStop where film:exposure:stop is iris, is "
        "exposed for as a T-stop, which has the light that the glass takes in it already; filters still darken. The "
        "size of the iris is fStop's either way.",
        unit="none, a token",
        keyable=False,
        rest="exposure",
        option=Option("--stops-are"),
    )
    natural_vignetting: bool = setting(
        "lens:naturalVignetting",
        False,
        "Natural Vignetting",
        "Whether ideal lenses darken the corners by cos⁴, as real ones do.",
        "It counts for lenses without surfaces (pinhole, thin, seidel, or a dataSheet without lens:table:vignetting), to "
        "the power of lens:aberration:vignetting. Lenses with surfaces have it in their rays. False lights the picture "
        "evenly, as other USD renderers do.",
        unit="none, a switch",
        rest="exposure",
        option=Option("--natural-vignetting"),
    )
    squeeze: float = setting(
        "lens:squeeze",
        1.0,
        "Anamorphic Squeeze",
        "Ratio by which the lens sees wider than a spherical lens of the same focal length: 1 is spherical, 2 the "
        "classic anamorphic.",
        "Out-of-focus points stretch upright by the same factor in the picture once it is unsqueezed.",
        unit="none, a ratio",
        hard=(0.1, 10),
        soft=(1, 2),
    )
    close_focus: float = setting(
        "lens:closeFocus",
        0.0,
        "Close Focus",
        "The nearest distance that the lens can focus on, measured from the film as makers engrave it; 0 sets no "
        "limit.",
        unit="millimetres",
        hard=(0, None),
        soft=(None, 5000),
    )
    focus_throw: float = setting(
        "lens:focusThrow",
        0.0,
        "Focus Throw",
        "Turn of the focus ring from close focus to infinity, which bounds how fast a rack can be; 0 sets no bound.",
        unit="degrees",
        hard=(0, None),
        soft=(None, 360),
    )
    f_stop_range: Pair = setting(
        "lens:fStopRange",
        (0.0, 0.0),
        "F-Number Range",
        "The smallest and the largest f-number that the iris reaches (wide open, stopped down); 0 leaves that end "
        "unbounded.",
        unit="f-number",
    )
    pupil_magnification: float = setting(
        "lens:pupilMagnification",
        1.0,
        "Pupil Magnification",
        "Diameter of the exit pupil over that of the entrance pupil, P of the bellows factor (1 + m/P).",
        unit="none, a ratio",
        hard=(0.01, None),
        soft=(0.3, 3),
    )
    entrance_pupil_offset: float = setting(
        "lens:entrancePupilOffset",
        0.0,
        "Entrance Pupil Offset",
        "Where the entrance pupil lies along the view axis, from the camera's origin; positive toward the scene.",
        unit="millimetres",
        soft=(-200, 200),
    )
    pupil_power: Floats = setting(
        "lens:expressive:pupilPower",
        (),
        "Power over the Pupil",
        "Refractive power relative to the centre's, at even steps of the pupil's radius from centre to edge, joined "
        "smoothly: spherical aberration drawn by hand.",
        "Empty for the lens's own.",
        unit="none, ratios",
        group="Lens:Expressive",
    )
    expressive_blend: float = setting(
        "lens:expressive:blend",
        0.0,
        "Expressive Blend",
        "From the physical lens (0) to the hand-drawn one (1).",
        unit="none, a ratio from 0 to 1",
        hard=(0, 1),
        group="Lens:Expressive",
    )
    channel_index: Triple = setting(
        "lens:expressive:channelIndex",
        (0.0, 0.0, 0.0),
        "Channel Indices",
        "Refractive indices of the glass for red, green and blue (650, 510 and 475 nm) in place of its dispersion; zeros "
        "for the dispersion that it has.",
        "They are those of the first glass of a lens with surfaces. The other glasses bend each colour more or less by the "
        "same factor: a glass of index n has 1 + (n - 1) (N - 1) / (n1 - 1), with N given and n1 the first glass's own "
        "index at the d line. In between the index is linear in the wavelength, and beyond it stays. "
        "lens:expressive:blend does not count here.",
        unit="none, ratios above 1, or three zeros",
        group="Lens:Expressive",
        rest="exposure",
        bounds=Bounds(0, 10),
        option=Option("--channel-index", "R,G,B"),
    )
    flare_ghosts: float = setting(
        "lens:flare:ghosts",
        0.0,
        "Ghosts",
        "Strength of the reflections between pairs of surfaces: 0 off, 1 as the prescription has them.",
        unit="none, a factor",
        hard=(0, None),
        soft=(None, 5),
        group="Lens:Flare",
        rest="exposure",
        slider=Slider(0, 5, 0.25, unit="×", zero="off", label="Ghosts", panel="glass"),
    )
    flare_star: float = setting(
        "lens:flare:star",
        0.0,
        "Diffraction Star",
        "Strength of the spikes that diffraction at the iris draws around bright points: 0 off, 1 physical.",
        unit="none, a factor",
        hard=(0, None),
        soft=(None, 5),
        group="Lens:Flare",
        rest="exposure",
        slider=Slider(0, 5, 0.25, unit="×", zero="off", label="Star", panel="glass"),
    )
    prescription: Prescription = group(Prescription)
    configurations: Configurations = group(Configurations)
    seidel: Seidel = group(Seidel)
    height_field: HeightField = group(HeightField)
    data_sheet: DataSheet = group(DataSheet)
    aberration: AberrationScales = group(AberrationScales)
    hydra_distortion: HydraDistortion = group(HydraDistortion)
    split_diopter: SplitDiopter = group(SplitDiopter)
