"""One opened shot, used by the command line and the service alike, so that both give the same pixels."""

from render.shot.focus.anchor import Picked, make_point
from render.shot.focus.readout import PlacedPoint, Readout
from render.shot.shot import Shot

__all__ = ["Picked", "PlacedPoint", "Readout", "Shot", "make_point"]
