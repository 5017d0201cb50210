"""On which terms an edit is made: entity tags and ``If-Match``, so that two editors do not overwrite each other.

The tag of a focus point, of a camera or of all edits is made of what is *authored* there in the edit layer, the one thing that
edits change. What is solved from it (depths, shares, who is sharp) and the time of asking do not enter: an editor is to
hear that somebody changed the same thing, not that a neighbour moved. Answers that carry such a tag are not to be cached.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from render.errors import InputError


class ChangedMeanwhileError(InputError):
    """What was to be edited is not what the editor saw: HTTP 412."""

    default_code = "changed_meanwhile"


@dataclass(frozen=True)
class Terms:
    """What an edit asks for beside itself.

    Attributes:
        if_match: the ``If-Match`` header: tags of what the editor saw; None edits whatever is there.
        gesture: names the drag of a hand that the edit is part of, one step of undo; empty for none.
    """

    if_match: str | None = None
    gesture: str = ""

    def check(self, tag: str, what: str) -> None:
        """Go on if the editor saw what is there.

        Args:
            tag: of what is there now.
            what: for the message, such as "focus point 'hero'".

        Raises:
            ChangedMeanwhileError: it is something else.
        """
        if self.if_match is not None and not allows(self.if_match, tag):
            raise ChangedMeanwhileError(
                f"{what} was changed since it was read with the tag {self.if_match[:80]}; its tag is {tag} now: "
                "read it again and repeat the edit if it is still wanted",
                path="if-match",
            )


ANY_TERMS = Terms()


def tag_of(*words: str) -> str:
    """A strong entity tag, quotes included: another one for other words.

    Args:
        words: all that must be the same for the tag to be.
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
    """Whether an ``If-Match`` header lets an edit of a thing go on (RFC 9110, section 13.1.1: by strong comparison).

    Args:
        if_match: the header.
        tag: of the thing as it is.
    """
    named = [part.strip() for part in if_match.split(",")]
    return tag in named or named == ["*"]
