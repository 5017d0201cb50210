"""The one exception of the schema package, which imports nothing else of Pullfocus."""

from __future__ import annotations


class SchemaError(ValueError):
    """A camera, a focus point, a value or the plugin itself is not as the schema has it.

    The message is one sentence that names the thing, what was expected and what was got.
    """
