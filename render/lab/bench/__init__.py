"""Benches: what an engine costs and how near it comes to the truth, measured in one run.

They import neither pxr, OpenImageIO nor OpenColorIO, so that ``python -m render.lab.bench.lens`` runs on a bare GPU machine.
"""
