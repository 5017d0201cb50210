"""One opened shot, used by the command line and the service alike, so that both give the same pixels."""

from render.shot.anchor import Picked, anchored
from render.shot.picture import Picture, make_picture
from render.shot.readout import PlacedPoint, Readout
from render.shot.shot import Shot

__all__ = ["Picked", "Picture", "PlacedPoint", "Readout", "Shot", "anchored", "make_picture"]
