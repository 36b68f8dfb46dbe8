"""Table of the papers for the README: where each is, how to reproduce it, and what became of its print."""

from __future__ import annotations

import csv
import io
from collections import Counter

from study.cases.library import case_names, load_case
from study.cases.papers import paper_of
from study.cases.published import papers
from study.datafiles import data_folder
from study.files import read_file
from study.reproduction.book import SHORT
from study.reproduction.tally import AGREEING
from study.reproduction.verdicts import CANNOT_STAND, Basis

HEADS = (
    "paper",
    "case",
    "command",
    "tested by runs: reproduced",
    "checked by formula or print: consistent",
    "cannot stand as printed",
)


def papers_in_markdown() -> str:
    """Write a row for each paper, counted from the verdicts under version control.

    Raises
    ------
    StudyError
        If there is no table of verdicts.
    """
    text = read_file(data_folder() / "verdicts.csv").decode("utf-8")
    rows = list(csv.DictReader(io.StringIO(text, newline="")))
    cases = {case.paper: name for name in case_names(default_only=True) if (case := load_case(name))}
    lines = [HEADS, ("---",) * len(HEADS)]
    for short, key in SHORT.items():
        counts = Counter((row["rests on"], row["verdict"]) for row in rows if row["paper"] == key)
        citation, known = papers()[key], paper_of(key)
        link = f"[{citation}](https://doi.org/{known.doi})" if known else citation
        wrong = sum(number for (_, verdict), number in counts.items() if verdict in CANNOT_STAND)
        lines.append(
            (
                link,
                f"`{cases[key]}`",
                f"`study reproduce {short}`",
                _agreeing(counts, Basis.RUNS),
                _agreeing(counts, Basis.FORMULA, Basis.PRINT),
                str(wrong),
            )
        )
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _agreeing(counts: Counter[tuple[str, str]], *bases: Basis) -> str:
    chosen = {key: number for key, number in counts.items() if key[0] in bases}
    agree = sum(number for (_, verdict), number in chosen.items() if verdict in AGREEING)
    return f"{agree} of {sum(chosen.values())}"
