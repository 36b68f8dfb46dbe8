"""The papers, their citations and their questions: `data/papers.yaml`."""

from __future__ import annotations

from dataclasses import dataclass

from study.cases.ledger import Entry, ledger
from study.cases.published import papers
from study.datafiles import Strict, checked, data_folder, read_yaml


class _Question(Strict):
    doi: str
    question: str


@dataclass(frozen=True)
class Paper:
    """A paper in the report: its question in our words, its citation, and our findings in it."""

    citation: str
    doi: str
    question: str
    ledger: tuple[Entry, ...]


def paper_of(key: str) -> Paper | None:
    """Look a paper up; None for a key that is not one of the papers, such as that of a user's own case."""
    path = data_folder() / "papers.yaml"
    questions = read_yaml(path)
    if key not in questions or key not in papers():
        return None
    asked = checked(_Question, questions[key], f"file {path.name!r}: {key}")
    return Paper(papers()[key], asked.doi, asked.question, ledger(key))
