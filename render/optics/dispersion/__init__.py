"""Dispersion of optical glass: formulas of makers' catalogues, the catalogue itself, and glass known by index and Abbe number."""
