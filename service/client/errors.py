"""The exceptions of the client.

ClientError
├── ConnectionFailedError   no answer came: the service is not there, or the connection broke
├── RefusedError            the service refused the request, and said why
├── AnswerError             the answer is none of this service, or is damaged
├── FileError               a file of this machine cannot be read or written
├── SettingError            an address, a key or a setting cannot be sent
└── WaitTimeoutError        a render has not ended in the time that was given
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


class ClientError(Exception):
    """Root of all errors that the client raises on purpose; each is one sentence."""


class ConnectionFailedError(ClientError):
    """No answer came: the service is not there, or the connection broke."""


class AnswerError(ClientError):
    """The answer is none of this service, or is damaged."""


class FileError(ClientError):
    """A file of this machine cannot be read or written."""


class SettingError(ClientError):
    """An address, a key or a setting cannot be sent."""


class WaitTimeoutError(ClientError):
    """A render has not ended in the time that was given; it goes on."""


@dataclass(frozen=True)
class Finding:
    """A finding and its subject.

    Attributes:
        path: file, prim or parameter.
        detail: one sentence.
    """

    path: str
    detail: str


class RefusedError(ClientError):
    """The service refused a request.

    Attributes:
        status: HTTP status.
        code: short stable word for programs, such as ``shot_not_found``.
        detail: one sentence for people.
        path: file, prim or parameter that it is about, if any.
        errors: the single findings, where there are several.
    """

    def __init__(
        self, status: int, code: str, detail: str, path: str | None = None, errors: Sequence[Finding] = ()
    ) -> None:
        super().__init__(detail)
        self.status = status
        self.code = code
        self.detail = detail
        self.path = path
        self.errors = tuple(errors)
