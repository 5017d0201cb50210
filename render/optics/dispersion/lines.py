"""Spectral lines for which catalogues list refractive indices, in nanometres (ISO 7944)."""

from __future__ import annotations

D_LINE_NM, F_LINE_NM, C_LINE_NM = 587.5618, 486.1327, 656.2725  # helium, hydrogen, hydrogen
G_LINE_NM, H_LINE_NM = 435.8343, 404.6561  # mercury
R_LINE_NM = 706.5188  # helium
CHANNELS_NM = (650.0, 510.0, 475.0)
"""Wavelengths of red, green and blue, one for each channel (Lee, Eisemann & Seidel 2010, section 4)."""
