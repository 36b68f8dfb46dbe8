"""Suites by name: the papers' cases, and those of the files in `data/suites`."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from study.cases.case import Case
from study.cases.library import case_names, load_case
from study.cases.suite_file import SuiteProblem, filed_suite, filed_suites
from study.datafiles import data_folder
from study.errors import unknown

PAPERS = "papers"


@dataclass(frozen=True, eq=False)
class Suite:
    """A named set of problems.

    Attributes
    ----------
    name, about : str
    version : int
    checksum : str
        Of the problems' content, 16 hexadecimal digits.
    cases : dict of str to Case
        By the name that `load_case` takes.
    problems : dict of str to SuiteProblem
        What the file says of each; empty for the papers.
    """

    name: str
    about: str
    version: int
    checksum: str
    cases: dict[str, Case]
    problems: dict[str, SuiteProblem]


def suite_names() -> list[str]:
    """Names of all suites."""
    return [PAPERS, *filed_suites()]


def suite_named(name: str) -> Suite:
    """Load a suite.

    Raises
    ------
    StudyError
        If there is none of this name, or its data are broken.
    """
    if not isinstance(name, str) or name not in suite_names():
        raise unknown("suite", name, suite_names())
    if name == PAPERS:
        return _papers()
    file = filed_suite(name)
    problems = {f"{name}:{problem.name}": problem for problem in file.problems}
    cases = {key: problem.case(name) for key, problem in problems.items()}
    return Suite(name, file.about, file.version, file.checksum, cases, problems)


def _papers() -> Suite:
    """The papers' five cases as they stand; the checksum is that of their files."""
    files = sorted((data_folder() / "cases").glob("*.yaml"))
    digest = hashlib.sha256(b"".join(path.read_bytes().replace(b"\r\n", b"\n") for path in files)).hexdigest()[:16]
    cases = {name: load_case(name) for name in case_names(default_only=True)}
    return Suite(PAPERS, "the five papers' own cases", 1, digest, cases, {})
