"""Limits of the layers that those need to know who draw none."""

MAX_LAYERS = 8
