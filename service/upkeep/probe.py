"""Prints what the libraries of a worker say of themselves, as JSON: ``python -m service.upkeep.probe gl|libraries``.

It is a program of its own, because a driver or a library that is broken may end the process that asks it.
"""

from __future__ import annotations

import json
import sys


def graphics() -> dict[str, str]:
    """Create a GL context. Returns its renderer and version."""
    from render.gl.context import GraphicsContext

    context = GraphicsContext()
    return {"renderer": context.renderer, "version": context.ctx.info["GL_VERSION"]}


def libraries() -> dict[str, str]:
    """Load the libraries that read a shot and grade a picture. Returns their versions."""
    import OpenImageIO
    import PyOpenColorIO
    from pxr import Usd

    PyOpenColorIO.Config.CreateFromBuiltinConfig("ocio://default")
    return {
        "USD": ".".join(str(part) for part in Usd.GetVersion()),
        "OpenColorIO": PyOpenColorIO.GetVersion(),
        "OpenImageIO": OpenImageIO.VERSION_STRING,
    }


if __name__ == "__main__":
    print(json.dumps(graphics() if sys.argv[1] == "gl" else libraries()))
