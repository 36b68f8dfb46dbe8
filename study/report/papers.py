"""Which paper a case comes from and what that paper asks: `data/papers.yaml`."""

from __future__ import annotations

from functools import cache

from study.datafiles import Strict, checked, data_folder, read_yaml


class Paper(Strict):
    """How to cite a paper, and its question in our words."""

    citation: str
    doi: str
    question: str


@cache
def papers() -> dict[str, Paper]:
    """Read all papers by key."""
    path = data_folder() / "papers.yaml"
    return {key: checked(Paper, value, f"file {path.name!r}: {key}") for key, value in read_yaml(path).items()}
