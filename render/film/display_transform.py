"""OpenColorIO's transforms on the way to a display, in the order that grading tools have them.

    scene light:   working space → CDL → looks → the view's tone mapping → display
    print light:   ............. → CDL → looks → ................. colorimetric → display

A film's print has its tones already: it is shown as it is measured, whatever tone mapping the view has, and full light (1) is the
display's white. The CDL works in the configuration's ``color_timing`` space (ACEScct in ACES), as OpenColorIO's
``LegacyViewingPipeline`` has it, and in the working space where a configuration has none.
"""

from __future__ import annotations

import PyOpenColorIO as ocio

from render.colour import DEFAULT_CONFIG, working_config
from render.film.cdl import Cdl

_WORKING = ocio.ROLE_SCENE_LINEAR
_ACES = ocio.ROLE_INTERCHANGE_SCENE  # ACES2065-1: linear, with primaries that hold all colours
_MEASURED = ocio.ROLE_INTERCHANGE_DISPLAY  # CIE XYZ of what a display emits; Y = 1 is its white, which is D65
_MEASURED_FROM_ACES = "UTILITY - ACES-AP0_to_CIE-XYZ-D65_BFD"  # white stays white


class TransformChain:
    """Chain of transforms, split where the CDL works: only the CDL's numbers change from frame to frame.

    Attributes:
        parts: one, or two where there is a CDL between them.
    """

    def __init__(self) -> None:
        self.parts = [ocio.GroupTransform()]

    def append(self, transform: ocio.Transform) -> None:
        """Append a transform to the last part."""
        self.parts[-1].appendTransform(transform)

    def append_all(self, processor: ocio.Processor) -> None:
        """Append the steps of a processor, which may be of another configuration."""
        for step in processor.createGroupTransform():
            self.append(step)

    def start_part(self) -> None:
        """Start the part that comes after the CDL."""
        self.parts.append(ocio.GroupTransform())

    def with_cdl(self, cdl: Cdl) -> ocio.GroupTransform:
        """Whole chain with a CDL."""
        whole = ocio.GroupTransform()
        for i, part in enumerate(self.parts):
            if i:
                whole.appendTransform(cdl.transform())
            whole.appendTransform(part)
        return whole


def scene_to_display(config: ocio.Config, display: str, view: str, look: str | None, has_cdl: bool) -> TransformChain:
    """Chain from the working space to the display, by the view.

    That space is the working space of `render.colour.working_config`; where the grade is by another configuration, the two must
    have the role ``aces_interchange``.
    """
    way, rendered = TransformChain(), working_config()
    if config is not rendered:
        way.append_all(ocio.Config.GetProcessorFromConfigs(rendered, _WORKING, config, _WORKING))
    _append_grading(way, config, look, has_cdl)
    way.append(ocio.DisplayViewTransform(src=_WORKING, display=display, view=view))
    return way


def scene_to_space(space: str) -> TransformChain:
    """Chain from the working space to a space of OpenColorIO's default configuration, without any view."""
    way = TransformChain()
    way.append_all(ocio.Config.GetProcessorToBuiltinColorSpace(working_config(), _WORKING, space))
    return way


def print_to_display(
    config: ocio.Config, display: str, view: str, look: str | None, has_cdl: bool, light: str
) -> TransformChain:
    """Chain from a print's light to the display, without the view's tone mapping.

    Args:
        config: the configuration; it must have the role ``aces_interchange``, and for displays that are spaces of measured
            light, as they are since OpenColorIO 2, ``cie_xyz_d65_interchange``.
        display: of the configuration.
        view: its colour space is the one that the display is sent; a view of data is sent the light unchanged.
        look: as `render.film.Grade.look`.
        has_cdl: whether there is a place for a CDL.
        light: name of a linear space, of the configuration that was rendered by or of OpenColorIO's default one.
    """
    way, target = TransformChain(), config.getColorSpace(config.getResolvedDisplayViewColorSpaceName(display, view))
    if target is None or target.isData():
        return way
    way.append_all(_config_that_has(light).getProcessor(light, _ACES))
    if has_cdl or look:
        way.append(ocio.ColorSpaceTransform(src=_ACES, dst=_WORKING))
        _append_grading(way, config, look, has_cdl)
        way.append(ocio.ColorSpaceTransform(src=_WORKING, dst=_ACES))
    if target.getReferenceSpaceType() == ocio.REFERENCE_SPACE_DISPLAY:
        way.append(ocio.BuiltinTransform(style=_MEASURED_FROM_ACES))
        way.append(ocio.ColorSpaceTransform(src=_MEASURED, dst=target.getName()))
    else:
        way.append(ocio.ColorSpaceTransform(src=_ACES, dst=target.getName()))
    return way


def _append_grading(way: TransformChain, config: ocio.Config, look: str | None, has_cdl: bool) -> None:
    """Append the split for the CDL and then the looks, from the working space to itself."""
    if has_cdl:
        timing = ocio.ROLE_COLOR_TIMING if config.hasRole(ocio.ROLE_COLOR_TIMING) else _WORKING
        way.append(ocio.ColorSpaceTransform(src=_WORKING, dst=timing))
        way.start_part()
        way.append(ocio.ColorSpaceTransform(src=timing, dst=_WORKING))
    if look:
        way.append(ocio.LookTransform(src=_WORKING, dst=_WORKING, looks=look))


def _config_that_has(space: str) -> ocio.Config:
    rendered = working_config()
    return rendered if rendered.getColorSpace(space) is not None else working_config(DEFAULT_CONFIG)
