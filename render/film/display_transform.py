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


def scene_to_display(config: ocio.Config, display: str, view: str, look: str | None, cdl: Cdl) -> ocio.GroupTransform:
    """From the space that was rendered in to what the display is sent, by the view.

    That space is the working space of `render.colour.working_config`; where the grade is by another configuration, the two must
    have the role ``aces_interchange``.
    """
    way, rendered = ocio.GroupTransform(), working_config()
    if config is not rendered:
        _append_all(way, ocio.Config.GetProcessorFromConfigs(rendered, _WORKING, config, _WORKING))
    way.appendTransform(_graded(config, look, cdl))
    way.appendTransform(ocio.DisplayViewTransform(src=_WORKING, display=display, view=view))
    return way


def print_to_display(
    config: ocio.Config, display: str, view: str, look: str | None, cdl: Cdl, light: str
) -> ocio.GroupTransform:
    """From a print's light to what the display is sent, without the view's tone mapping.

    Args:
        config: the configuration; it must have the role ``aces_interchange``, and for displays that are spaces of measured
            light, as they are since OpenColorIO 2, ``cie_xyz_d65_interchange``.
        display: of the configuration.
        view: its colour space is the one that the display is sent; a view of data is sent the light unchanged.
        look: as `render.film.Grade.look`.
        cdl: likewise.
        light: name of a linear space, of the configuration that was rendered by or of OpenColorIO's default one.
    """
    target = config.getColorSpace(config.getResolvedDisplayViewColorSpaceName(display, view))
    way = ocio.GroupTransform()
    if target is not None and target.isData():
        return way
    grading = _graded(config, look, cdl)
    _append_all(way, _config_that_has(light).getProcessor(light, _ACES))
    if len(grading):
        way.appendTransform(ocio.ColorSpaceTransform(src=_ACES, dst=_WORKING))
        way.appendTransform(grading)
        way.appendTransform(ocio.ColorSpaceTransform(src=_WORKING, dst=_ACES))
    if target is not None and target.getReferenceSpaceType() == ocio.REFERENCE_SPACE_DISPLAY:
        way.appendTransform(ocio.BuiltinTransform(style=_MEASURED_FROM_ACES))
        way.appendTransform(ocio.ColorSpaceTransform(src=_MEASURED, dst=target.getName()))
    elif target is not None:
        way.appendTransform(ocio.ColorSpaceTransform(src=_ACES, dst=target.getName()))
    return way


def _graded(config: ocio.Config, look: str | None, cdl: Cdl) -> ocio.GroupTransform:
    """The CDL and then the looks, from the working space to itself; empty where there are none."""
    way = ocio.GroupTransform()
    if not cdl.is_neutral:
        timing = ocio.ROLE_COLOR_TIMING if config.hasRole(ocio.ROLE_COLOR_TIMING) else _WORKING
        way.appendTransform(ocio.ColorSpaceTransform(src=_WORKING, dst=timing))
        way.appendTransform(cdl.transform())
        way.appendTransform(ocio.ColorSpaceTransform(src=timing, dst=_WORKING))
    if look:
        way.appendTransform(ocio.LookTransform(src=_WORKING, dst=_WORKING, looks=look))
    return way


def _config_that_has(space: str) -> ocio.Config:
    rendered = working_config()
    return rendered if rendered.getColorSpace(space) is not None else working_config(DEFAULT_CONFIG)


def _append_all(way: ocio.GroupTransform, processor: ocio.Processor) -> None:
    """Append a processor of one configuration to a way through another."""
    for step in processor.createGroupTransform():
        way.appendTransform(step)
