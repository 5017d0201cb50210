"""The umbra of a peeled surface, hidden from the whole lens, and the number of layers that there can be.

Lee, Eisemann & Seidel 2010, section 3.1, extend the surface that is peeled at a pixel to the centres of the neighbouring
pixels, and skip surfaces in the shadow it would cast if the lens were a lamp: behind a surface at depth ``d``, whose extension
by a pixel is ``s = d / f_px``, a pupil of radius ``E`` sees nothing nearer than ``d + x`` on the pixel's ray, with
``x = d·s / (E - s)``.

In inverse depth that is a constant, and it holds for any pupil. Every ray of any lens is a line ``s(w) = a + b·w`` on the
layers, in pixels, with ``b`` the focal length in pixels times where the ray passes the plane of the entrance pupil, seen from
the point that the layers are peeled from. A ray that would meet, at the centre of a pixel, something at ``w' < w`` behind the
pixel's surface at ``w`` has passed that surface's depth ``|b|·(w - w')`` pixels beside the centre; if that is no more than
one, it was stopped by the surface or its extension. So with ``pupil_px = max |b|`` over all rays (pixel metres),

    hidden from every ray:  w' >= w - 1 / pupil_px

wherever the surface is. ``pupil_px`` is ``f_px·E`` where ``E`` is the greatest distance from the point of peeling to any point
of the pupil that light passes: the radius of a round pupil about it; the longer half axis of an elliptical one, times the
larger of two unequal focal lengths; and for a pupil that lies to one side, its far edge. That is why layers are best peeled
from the middle of the pupil. For the paper's round pupil ``1 / (d + x) = w·(1 - s/E) = w - 1/(f_px·E)``: the same.

A surface that is partly transparent hides nothing. Opaque ones follow each other in a pixel in steps of more than
``1 / pupil_px``, from ``w_near`` at most to more than 0 at least, so that there are never more than ``ceil(w_near·pupil_px)``
of them, whatever the scene; one, where no blur of any two depths differs by more than a pixel. (The paper's example, field of
30 degrees, 600 pixels, nearest depth 1 m, pupil of 9 mm: ``w_near·pupil_px`` is 10.1, and the paper gives ten.)

The argument neglects that a ray may meet the hidden surface up to half a pixel beside a pixel's centre. It may then pass the
extension by as much, and sees the surface of the next pixel instead.
"""

from __future__ import annotations

import math

HIDES_ALL = 1e30
"""Umbra of a pinhole, 1/m: an opaque surface hides everything behind it."""


def umbra_reach(pupil_px: float) -> float:
    """Reach of an opaque surface's extended umbra in inverse depth, 1/m; the same wherever the surface is.

    Args:
        pupil_px: the largest ``|b|`` of all rays, layer pixels times metres: focal length in pixels times the greatest
            distance in metres from the point of peeling to where a ray passes the plane of the entrance pupil.
    """
    return 1.0 / pupil_px if pupil_px > 0 else HIDES_ALL


def layers_needed(pupil_px: float, w_near: float) -> int:
    """Upper bound on the number of layers that hold anything a ray may see, where all surfaces are opaque.

    Args:
        pupil_px: as for `umbra_reach`.
        w_near: the largest inverse depth in view, 1/m.
    """
    return max(1, math.ceil(w_near * pupil_px))
