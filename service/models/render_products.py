"""Products of a render: what is made once its frames are stored."""

from __future__ import annotations

from typing import Literal, get_args

from pydantic import Field

from service.models.base import Model

ProductName = Literal[
    "movie.mp4",
    "movie.mov",
    "movie.webm",
    "contact-sheet.png",
    "focus-report.html",
    "focus-report.csv",
    "focus-report.json",
    "focus-curve.json",
    "focus-curve.csv",
    "focus-curve.usda",
    "focus-curve.otio",
    "focus-curve.opentrackio",
]
"""Kind of a product, a dot, and its format."""
PRODUCTS: tuple[ProductName, ...] = get_args(ProductName)
ProductState = Literal["waiting", "running", "done", "failed", "canceled"]


def needs_pictures(name: str) -> bool:
    """Return whether a product is made of graded pictures; the others need the shot alone."""
    return name.startswith(("movie.", "contact-sheet."))


class RenderProduct(Model):
    """A product of a render and how far it is."""

    name: ProductName
    state: ProductState = Field(
        description="`waiting`: for the frames, or its turn. `canceled`: it was given up with the render."
    )
    size_bytes: int | None = Field(description="Size of its file, bytes; null before it is made.")
    error: str | None = Field(description="What went wrong; null where nothing has.")
