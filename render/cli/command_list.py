"""The commands of `pullfocus` that this package has."""

COMMANDS = {
    "record": ("record", "render frames of a shot to EXR, PNG or JPEG files"),
    "inspect": ("inspect", "cameras, frame range, settings that are not honoured, validation findings"),
    "focus-curve": ("focus_curve", "write the focus over time for other tools, or import their curves as a USD layer"),
    "meter": ("meter", "light meter readings in EV, lux and stops; --key writes them as keys of the exposure"),
    "lenses": ("lenses", "the lens library; `lenses show NAME` has the numbers and a sheet of one"),
    "films": ("films", "the film library; `films show NAME` has the numbers and a data sheet of one"),
    "bodies": ("bodies", "camera bodies and film formats; `bodies show NAME` has fields of view and framing guides"),
    "splats": ("splats", "write a captured set of Gaussian splats (.ply) as a USD layer"),
    "demo": ("demo", "write the demo shot"),
}
"""Module of `render.cli` that has a command's ``add_arguments``, and its purpose, by its name."""
