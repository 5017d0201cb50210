"""The exceptions that Pullfocus raises on purpose.

    PullfocusError
    ├── SettingsError      an argument or a setting is out of range or of the wrong kind   (exit 2, HTTP 422)
    ├── InputError         input that cannot be used                                       (exit 1, HTTP 422)
    │   ├── StageError     a file is no USD stage, is damaged, or refers to what lies outside
    │   ├── CameraError    the named camera is missing, no camera, or has impossible values
    │   └── NotFoundError  a named thing (focus point, key, shot) does not exist           (HTTP 404)
    ├── GraphicsError      no OpenGL context, or the driver refused a shader or a buffer   (exit 1, HTTP 503)
    └── OutputError        a result could not be written                                   (exit 1, HTTP 507)

Each message is one sentence, on one line, that names the thing, what was expected and what was got.
The command line and the service translate them, once each.
"""

from __future__ import annotations

import unicodedata

_BREAKS_A_LINE = frozenset(
    {"Cc", "Cs", "Zl", "Zp"}
)  # control characters, halves of pairs, separators of lines and paragraphs


def one_line(text: str) -> str:
    """Format foreign text, such as a file's name, on one line: line breaks are written as in Python's repr."""
    if text.isprintable():
        return text
    return "".join(repr(c)[1:-1] if unicodedata.category(c) in _BREAKS_A_LINE else c for c in text)


class PullfocusError(Exception):
    """Root of all errors that are raised on purpose.

    Attributes:
        detail: the message.
        code: a short stable word for programs, such as ``stage_unreadable``.
        path: the file or prim path that the error is about, if any.
    """

    default_code = "error"

    def __init__(self, detail: str, *, code: str | None = None, path: str | None = None) -> None:
        self.detail = one_line(detail)
        super().__init__(self.detail)
        self.code = code or self.default_code
        self.path = path


class SettingsError(PullfocusError):
    """An argument or setting is out of range or of the wrong kind."""

    default_code = "bad_setting"


class InputError(PullfocusError):
    """Input that cannot be used."""

    default_code = "bad_input"


class StageError(InputError):
    """File that is not a USD stage, is damaged, or refers to files outside its folder."""

    default_code = "bad_stage"


class CameraError(InputError):
    """The named camera is missing, is no camera, or has impossible values."""

    default_code = "bad_camera"


class NotFoundError(InputError):
    """A named thing does not exist."""

    default_code = "not_found"


class GraphicsError(PullfocusError):
    """No OpenGL context could be made, or the driver refused a shader or a buffer."""

    default_code = "graphics"

    def __init__(self, detail: str, *, code: str | None = None, path: str | None = None) -> None:
        super().__init__(" ".join(detail.split()), code=code, path=path)  # drivers say things in several lines


class RefusedProgramError(GraphicsError):
    """The driver refused the program of a material's network of nodes. Scenes that are read after that do without it."""


class OutputError(PullfocusError):
    """A result could not be written."""

    default_code = "output"
