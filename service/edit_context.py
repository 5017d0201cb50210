"""Entity tags of what can be edited, and the ``If-Match`` condition that keeps two editors from overwriting each other.

The tag of a focus point, of a camera or of all edits is a hash of what the edit layer *authors* there, the only thing that edits
change. Solved values (depths, shares, sharpness) and the time of the request do not enter: a tag changes when the
same thing is edited, not when a neighbour moves. Answers that carry such a tag must not be cached.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from render.errors import InputError


class ChangedMeanwhileError(InputError):
    """The edited thing is not what the editor saw: HTTP 412."""

    default_code = "changed_meanwhile"


@dataclass(frozen=True)
class EditContext:
    """Condition of an edit, the gesture that it is part of, and who makes it.

    Attributes:
        if_match: the ``If-Match`` header: tags that the editor has seen; None edits without a condition.
        gesture: name of the drag that the edit is part of, all of which is one step of undo; empty for none.
        author: name of the sender for people; empty where senders are not known by name.
    """

    if_match: str | None = None
    gesture: str = ""
    author: str = ""

    def check_tag(self, tag: str, what: str) -> None:
        """Check the ``If-Match`` condition.

        Args:
            tag: present tag of the edited thing.
            what: the thing, for the message, such as "focus point 'hero'".

        Raises:
            ChangedMeanwhileError: the editor has seen another tag.
        """
        if self.if_match is not None and not allows(self.if_match, tag):
            raise ChangedMeanwhileError(
                f"{what} was changed since it was read with the tag {self.if_match[:80]}; its tag is {tag} now: "
                "read it again and repeat the edit if it still applies",
                path="if-match",
            )


ANY_CONTEXT = EditContext()


def tag_of(*words: str) -> str:
    """Return a strong entity tag, quotes included.

    Args:
        words: the tag is the same where all of these are.
    """
    text = "\0".join(words)
    return f'"{hashlib.sha256(text.encode()).hexdigest()[:16]}"'


def edits_tag(revision: str) -> str:
    """Entity tag of all edits of a shot: its revision in quotes.

    Args:
        revision: of the edits.
    """
    return f'"{revision}"'


def allows(if_match: str, tag: str) -> bool:
    """Evaluate an ``If-Match`` header by strong comparison (RFC 9110, section 13.1.1).

    Args:
        if_match: the header.
        tag: present tag of the thing.
    """
    named = [part.strip() for part in if_match.split(",")]
    return tag in named or named == ["*"]
