"""One opened shot, used by the command line and the service alike, so that both give the same pixels."""

from render.shot.focus.anchor import SurfacePoint, make_point
from render.shot.focus.readout import PlacedPoint, Readout
from render.shot.shot import Shot

__all__ = ["PlacedPoint", "Readout", "Shot", "SurfacePoint", "make_point"]
