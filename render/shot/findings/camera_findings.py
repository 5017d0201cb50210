"""Findings of cameras and lights: settings that contradict each other or go beyond limits, and focus that cannot be met."""

from __future__ import annotations

from collections.abc import Iterator, Sequence, Sized

from pxr import Usd, UsdGeom

from render.errors import PullfocusError
from render.layers.light_filters import place_filters
from render.layers.lights import MAX_LIGHTS, select_lights
from render.layers.shadows import MAX_SHADOW_MAPS, lights_without_shadow
from render.model.light_filters import MAX_FILTERS
from render.model.limits import MAX_CLIP_PLANES
from render.model.scene import Light
from render.near_names import hint
from render.optics.prescription.mounting import PRESCRIBED, beyond_zoom_range, nearer_than_marked
from render.shot.findings.topology_findings import topology_findings
from render.shot.focus.focused_camera import FocusedCamera
from render.stage import Finding, stereo_role
from render.stage.camera.stereo import ROLES
from usd_schemas import LensCamera, LensData

_SHAPES = "spherical", "coma", "astigmatism", "field_curvature", "distortion"
"""Factors on errors that a lens with cylinders does not have by kinds."""


def camera_findings(stage: Usd.Stage, camera_paths: Sequence[str]) -> list[Finding]:
    """Find the settings of each camera that have no effect beside its others.

    Args:
        stage: the stage.
        camera_paths: of its cameras.
    """
    return [
        finding for path in camera_paths for finding in _findings_of_camera(LensCamera(stage.GetPrimAtPath(path)), path)
    ]


def light_findings(lights: tuple[Light, ...]) -> list[Finding]:
    """Find each light beyond the renderer's limits on lights, filters and shadow maps."""
    drawn = select_lights(lights)
    dropped = [light.path for light in lights if max(light.radiance) > 0 and light not in drawn]
    many = f"is not honoured: the strongest {MAX_LIGHTS} lights of the shot are"
    full = f"casts no shadow: stronger lights have all {MAX_SHADOW_MAPS} shadow maps (a bare sphere, cylinder or mesh needs six)"
    findings = [Finding("too_many_lights", path, f"light {path} {many}") for path in dropped]
    placed = place_filters(drawn)
    unfiltered = [light.path for i, light in enumerate(drawn) if light.filters and i not in placed]
    bare = f"shines without its filters: up to {MAX_FILTERS} filters of lights are honoured"
    findings += [Finding("too_many_filters", path, f"light {path} {bare}") for path in unfiltered]
    return findings + [Finding("shadow_maps", path, f"light {path} {full}") for path in lights_without_shadow(drawn)]


def lost_point_findings(focused: FocusedCamera) -> list[Finding]:
    """Find each focus point that should count, but whose target is missing or whose numbers have no meaning.

    Args:
        focused: a camera, its focus solved.
    """
    kept = focused.solution.source == "camera"
    codes = ("lost_focus_point", "bad_focus_point")
    so = "the camera's own focus distance is kept" if kept else "the other points decide the focus"
    return [
        Finding(codes[point.name in focused.at_fault], focused.camera.path, f"{focused.problems[point.name]}, so {so}")
        for point, state in zip(focused.points, focused.solution.states, strict=True)
        if state == "lost"
    ]


def unmet_findings(focused: FocusedCamera) -> list[Finding]:
    """Find a lens or focal surface that cannot be set as its focus points request.

    Args:
        focused: a camera, its focus solved.
    """
    path = focused.camera.path
    return [Finding("focus_not_as_asked", path, f"{path}: {focused.note}")] if focused.note else []


def close_focus_findings(focused: FocusedCamera) -> list[Finding]:
    """Find a camera that is focused nearer than its lens is marked for; it is rendered so, as with an extension tube.

    A focus that its glass cannot reach is no finding, but an error when it is rendered.
    """
    camera = focused.camera
    try:
        nearer = nearer_than_marked(camera)
    except PullfocusError:
        return []
    where = f"nearer than the {camera.lens.close_focus_m:g} m before the film that its lens is marked for"
    how = "it is drawn as if the lens stood on an extension tube"
    return [Finding("close_focus", camera.path, f"{camera.path} is focused {where}: {how}")] if nearer else []


def zoom_range_findings(focused: FocusedCamera) -> list[Finding]:
    """Find a camera whose focal length is beyond the range of its zoom; its nearer end is drawn, scaled."""
    camera = focused.camera
    try:
        span = beyond_zoom_range(camera)
    except PullfocusError:
        return []
    if span is None:
        return []
    name, (shortest, longest) = camera.lens.name or "its lens", span
    message = f"{camera.path} is zoomed beyond {name}, which zooms from {shortest:.4g} to {longest:.4g} mm"
    how = "the nearer end of the range is drawn, scaled, which no such lens is"
    return [Finding("zoom_range", camera.path, f"{message}: {how}")]


def _findings_of_camera(camera: LensCamera, path: str) -> Iterator[Finding]:
    mode = camera.focus.read().mode
    if mode == "manual" and camera.focus_points():
        yield Finding(
            "focus_points_unused", path, f"{path} has focus points but is focused by hand, as its focus:mode is manual"
        )
    metering, points = camera.film.read().metering, [point.name for point in camera.focus_points()]
    if metering.mode == "spot" and metering.focus_point not in ("", *points):
        which = f"meters the focus point {metering.focus_point!r}, which it does not have"
        yield Finding("metering_point", path, f"{path} {which}: {hint(metering.focus_point, points)}")
    lens = camera.lens.read()
    if lens.flare_ghosts > 0 and lens.model not in PRESCRIBED:
        yield Finding(
            "no_ghosts", path, f"{path} asks for ghosts, but its {lens.model} lens has no surfaces that could reflect"
        )
    if lens.model == "prescription" and lens.prescription.radius_across:
        yield from _findings_of_cylinders(lens, path)
    yield from topology_findings(camera)
    from usd_schemas.validation.key_rules import counting, two_drivers  # with all rules: not before the first picture

    for rule in (two_drivers, counting):
        for fault in rule(camera.prim):
            yield Finding("contradictory_keys", str(fault.path), fault.message)
    projection = UsdGeom.Camera(camera.prim).GetProjectionAttr().Get(Usd.TimeCode.EarliestTime())
    if projection == UsdGeom.Tokens.orthographic and lens.model not in ("thin", "pinhole"):
        message = f"{path} is orthographic: it has a thin lens of parallel rays in place of its {lens.model} one"
        yield Finding("orthographic", path, message)
    role = stereo_role(camera.prim)
    if role not in ROLES:
        yield Finding(
            "bad_stereo_role", path, f"stereoRole of {path} must be {' or '.join(ROLES)}, got {role}: it is mono"
        )
    planes = UsdGeom.Camera(camera.prim).GetClippingPlanesAttr().Get(Usd.TimeCode.EarliestTime())
    if isinstance(planes, Sized) and len(planes) > MAX_CLIP_PLANES:
        message = f"{path} has {len(planes)} clippingPlanes: only the first {MAX_CLIP_PLANES} clip"
        yield Finding("unsupported_camera_property", f"{path}.clippingPlanes", message)


def _findings_of_cylinders(lens: LensData, path: str) -> Iterator[Finding]:
    """Find what a lens with cylinders does not draw."""
    if lens.flare_ghosts > 0:
        yield Finding("no_ghosts", path, f"{path} asks for ghosts, but those of a lens with cylinders are not traced")
    factors = [name for name in _SHAPES if getattr(lens.aberration, name) != 1]
    if factors:
        named = ", ".join(name.replace("_", " ") for name in factors)
        yield Finding("no_factors", path, f"{path} scales {named}, but a lens with cylinders keeps them as they are")
