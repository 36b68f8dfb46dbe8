"""The ledger: what the papers misprint, contradict or leave out, and how this study reads it."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Literal

from pydantic import Field

from study.cases.published import papers
from study.datafiles import Strict, checked, data_folder, read_yaml
from study.errors import StudyError, unknown

Text = Annotated[str, Field(min_length=1)]


class Entry(Strict):
    """One finding in one paper.

    Attributes
    ----------
    id : str
    paper : str
        Key of the paper.
    kind : str
        `misprint`, `contradiction`, `gap` or `ambiguity`.
    place : str
        Table, equation or section.
    printed : str
        What stands there, or what is missing.
    problem : str
        Why it cannot be meant as it stands.
    reading : str
        What this study does instead.
    consequence : str
        What the readings give where they can be run; may be empty.
    """

    id: Text
    paper: Text
    kind: Literal["misprint", "contradiction", "gap", "ambiguity"]
    place: Text
    printed: Text
    problem: Text
    reading: Text
    consequence: str = ""


class _LedgerFile(Strict):
    entries: list[Entry]


@cache
def _entries() -> tuple[Entry, ...]:
    path = data_folder() / "ledger.yaml"
    entries = tuple(checked(_LedgerFile, read_yaml(path), f"file {path.name!r}").entries)
    ids = [entry.id for entry in entries]
    if doubled := {name for name in ids if ids.count(name) > 1}:
        raise StudyError(f"file {path.name!r}: entry {min(doubled)!r} stands twice; rename one")
    known = papers()
    for entry in entries:
        if entry.paper not in known:
            raise unknown(f"paper (in ledger entry {entry.id!r})", entry.paper, known)
    return entries


def ledger(paper: str | None = None) -> tuple[Entry, ...]:
    """Read the ledger, or one paper's part of it, in the order of the file.

    Raises
    ------
    StudyError
        If the paper is unknown, or the file is broken.
    """
    if paper is not None and paper not in papers():
        raise unknown("paper", paper, papers())
    return tuple(entry for entry in _entries() if paper in (None, entry.paper))
