"""The one error family: what a user can cause ends in a `StudyError` with a clear sentence."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Sequence


class StudyError(Exception):
    """A mistake the user can mend; its text, one line, says where, what was expected, what came and what would do."""

    def __str__(self) -> str:
        return "; ".join(
            filter(None, map(str.strip, super().__str__().splitlines()))
        )  # others' reasons may have several

    about_joint: tuple[str, int, tuple[float, ...], int] | None = None
    """Sentence, joint, values and their order, where the mistake is one joint's; see `joint_error`."""


class Interrupted(Exception):
    """Ctrl-C, with the sentence to say."""


def joint_error(sentence: str, joint: int, *values: float, order: int = 0, where: str = "") -> StudyError:
    """Build the error about one joint, which a reader of files can say again by the joint's name and in the file's units.

    Parameters
    ----------
    sentence : str
        With `{joint}` in the joint's place, and `{0}`, `{1}` in those of the values.
    joint : int
        Counted from 0.
    *values : float, rad or m, and s
    order : int
        Of the time derivative that the values are.
    where : str
        How the message begins.
    """
    said = sentence.format(*(f"{value:.10g}" for value in values), joint=f"joint {joint + 1}")
    error = StudyError(f"{where}: {said}" if where else said)
    error.about_joint = sentence, joint, values, order
    return error


def in_words_of(error: StudyError, names: Sequence[str], units: Sequence[str], factors: Sequence[float]) -> str:
    """Say an error about a joint by the names of joints and in units of which each is so many rad or m."""
    if error.about_joint is None:
        return str(error)
    sentence, joint, values, order = error.about_joint
    unit = units[joint] + ("", "/s", "/s²", "/s³")[order]
    said = [f"{value / factors[joint]:.10g} {unit}" for value in values]
    name = names[joint]
    return sentence.format(*said, joint=name if name == f"joint {joint + 1}" else f"joint {name!r}")


def unknown(kind: str, name: object, known: Iterable[str]) -> StudyError:
    """Build the error for a name that is not in a list, with the nearest names as a hint."""
    names = sorted(known)
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.4) if isinstance(name, str) else []
    hint = f"; did you mean {near[0]!r}?" if near else ";"
    said = repr(name) if isinstance(name, str) else short(name)
    return StudyError(f"no {kind} {said}{hint} known: {', '.join(names) or 'none'}")


def unforeseen(error: BaseException) -> str:
    """Type and text of an exception, without places in memory, which no two runs share: results repeat to the byte."""
    return re.sub(r" at 0x[0-9A-Fa-f]+", "", f"{type(error).__name__}: {error}")


def short(value: object) -> str:
    """Show any object in a few letters."""
    try:
        return repr(value)[:40] if isinstance(value, str | int | float | None) else f"{str(value)[:40]!r}"
    except ValueError:  # Python does not write out whole numbers of more than 4,300 digits
        return "a number of thousands of digits"


def plural(number: int, noun: str) -> str:
    """Number and noun, with an s where needed."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def listed(words: Sequence[str]) -> str:
    """Join words as in a sentence."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else ""
