"""The grade: OpenColorIO's display, view and look, and the ASC CDL."""

# ruff: noqa: RUF009  (setting() and group() are dataclasses.field with a declaration)

from __future__ import annotations

from dataclasses import dataclass

from usd_schemas.settings.setting import Asset, Bounds, Triple, schema_group, setting


@schema_group("Film:Grade", rest="film")
@dataclass(frozen=True)
class GradeData:
    """OpenColorIO's display, view and look, and the ASC CDL of the shot."""

    ocio_config: Asset = setting(
        "film:ocio:config",
        Asset(),
        "OpenColorIO Config",
        "The OpenColorIO configuration to grade by; empty takes the renderer's.",
        "Light is rendered in the working space of the renderer's own and converted through the role "
        "aces_interchange. A built-in one is named as ocio://name.",
        unit="none, a file",
        keyable=False,
        read_only=True,
    )
    display: str = setting(
        "film:ocio:display",
        "",
        "Display",
        "Name of the display; empty takes the configuration's default.",
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=200),
    )
    view: str = setting(
        "film:ocio:view",
        "",
        "View",
        "Name of the display's view; empty takes its default.",
        "The print of a film has its tones already, and is shown in the view's colour space without its tone mapping.",
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=200),
    )
    look: str = setting(
        "film:ocio:look",
        "",
        "Look",
        'Names of the configuration\'s looks, as OpenColorIO writes them, such as "+shot, -warm".',
        unit="none, text",
        keyable=False,
        bounds=Bounds(length=200),
    )
    cdl_slope: Triple = setting(
        "film:cdl:slope",
        (1.0, 1.0, 1.0),
        "CDL Slope",
        "ASC CDL slope of red, green and blue.",
        "The CDL works before the looks and the view, in the configuration's color_timing space (ACEScct in ACES), "
        "or in the working space where it has none; values are not clamped.",
        unit="none, factors of 0 or more",
    )
    cdl_offset: Triple = setting(
        "film:cdl:offset",
        (0.0, 0.0, 0.0),
        "CDL Offset",
        "ASC CDL offset of red, green and blue.",
        unit="none",
    )
    cdl_power: Triple = setting(
        "film:cdl:power",
        (1.0, 1.0, 1.0),
        "CDL Power",
        "ASC CDL power of red, green and blue.",
        unit="none, exponents above 0",
    )
    cdl_saturation: float = setting(
        "film:cdl:saturation",
        1.0,
        "CDL Saturation",
        "ASC CDL saturation, after slope, offset and power: 0 is grey, 1 leaves the colours.",
        unit="none, a factor",
        hard=(0, None),
        soft=(None, 2),
    )
    cdl_file: Asset = setting(
        "film:cdl:file",
        Asset(),
        "CDL File",
        "A .cdl, .cc or .ccc file that takes the place of the four numbers above.",
        unit="none, a file",
        keyable=False,
        read_only=True,
    )
    cdl_id: str = setting(
        "film:cdl:id",
        "",
        "CDL Correction",
        "Which correction of the file, by its id or its number from 0; empty takes the first.",
        unit="none, text",
        keyable=False,
        rest="",
    )
