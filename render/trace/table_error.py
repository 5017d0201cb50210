"""Error of the rays that a picture takes through a lens of glass, against exact ones."""

from __future__ import annotations

from render.gl.context import GraphicsContext
from render.gl.shaders import ProgramCache
from render.model.camera import Camera
from render.model.lens import AberrationScales
from render.optics.prescription.mounting import mount_lens
from render.optics.spectrum import spectrum
from render.optics.thin_lens import focus_w
from render.optics.view import PinholeView
from render.trace.bundles import corner_slope
from render.trace.prescription_table import make_prescription_table
from render.trace.surface_tracer import SurfaceTracer


def table_error_mm(camera: Camera) -> float:
    """Largest error on the film of the lens table of a camera with surfaces, mm; the picture's own table on this device.

    Args:
        camera: with its lens, f-number, focus and gate.

    Raises:
        GraphicsError: there is no device to trace with.
        InputError: the prescription is not a lens.
        SettingsError: it does not reach the focus distance.
    """
    with GraphicsContext() as graphics:
        graphics.make_current()
        tracer = SurfaceTracer(graphics.ctx, ProgramCache(graphics.ctx))
        table = make_prescription_table(
            tracer,
            mount_lens(camera),
            corner_slope(PinholeView.from_camera(camera, 2, 2)),
            focus_w(camera),
            spectrum(3).wavelengths_nm,
            AberrationScales(),
        )
    return table.film_error_mm
