"""Types of prims, and values of another type than their schema's: USD hands them out as they are."""

from __future__ import annotations

from pxr import Usd

# Errors of arithmetic on such values, or on numbers out of range.
UNREADABLE = (TypeError, ValueError, LookupError, AttributeError, ArithmeticError)
SPLATS = "ParticleField3DGaussianSplat"
"""Type of a prim that holds Gaussian splats."""


def schema_type(prim: Usd.Prim) -> str:
    """Name of the prim's schema: the first known one of the stage's ``fallbackPrimTypes`` where its own type is unknown."""
    return str(prim.GetPrimTypeInfo().GetSchemaTypeName())


def why_unreadable(problem: Exception) -> str:
    """The end of a sentence about a prim whose values raised one of `UNREADABLE`."""
    return f"its values cannot be read ({' '.join(str(problem).split())})"


def format_value(value: object) -> str:
    """Value formatted for a message, shortened, with its type, since the type is the fault."""
    text = repr(value) if len(repr(value)) <= 60 else f"{repr(value)[:60]}…"
    return f"{text} ({type(value).__name__})"


def number(attribute: Usd.Attribute, time: Usd.TimeCode) -> float:
    """An attribute's value as one number.

    Raises:
        TypeError: it is not one number; the message ends a sentence that begins with the attribute's owner.
    """
    value = attribute.Get(time)
    if not isinstance(value, int | float):
        raise TypeError(f"must be a number, got {format_value(value)}")
    return float(value)
