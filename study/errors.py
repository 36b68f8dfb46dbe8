"""The one error family: what a user can cause ends in a `StudyError` with a clear sentence."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence


class StudyError(Exception):
    """A mistake the user can mend; its text says where, what was expected, what came and what would do."""


class Interrupted(Exception):
    """Ctrl-C, with the sentence to say."""


def unknown(kind: str, name: str, known: Iterable[str]) -> StudyError:
    """Build the error for a name that is not in a list, with the nearest names as a hint."""
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.4)
    hint = f"; did you mean {near[0]!r}?" if near else ";"
    return StudyError(f"no {kind} {name!r}{hint} known: {', '.join(names) or 'none'}")


def plural(number: int, noun: str) -> str:
    """Number and noun, with an s where needed."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def listed(words: Sequence[str]) -> str:
    """Join words as in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""
