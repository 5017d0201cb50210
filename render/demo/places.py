"""Positions of the street's lights, in metres: shared by the set, the lighting and the pictures of reflected light."""

from __future__ import annotations

RAILS_X_M = (-1.15, 0.29)
LAMP_POSTS = ((-2.95, -9.6), (2.95, -13.2), (-2.95, -16.8), (2.95, -20.4))
LANTERNS = ((-2.75, 2.16, -5.75), (-2.15, 2.12, -5.66), (-1.55, 2.16, -5.75))
NEON_PLACE = (3.1, 2.72, -12.6)
TRAM_PLACE = (sum(RAILS_X_M) / 2, 0.0, -23.0)
