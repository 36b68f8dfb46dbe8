"""The command that makes the pictures of the README from real results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from study.analysis.case_summary import summarise
from study.cases.suites import suite_named
from study.cli.folder import DEFAULT_OUT, STORE_NAME, last_run, recording_file
from study.cli.screen import make_console
from study.cli.shared import Out
from study.errors import StudyError


def pictures(
    folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where the pictures go.")],
    case: Annotated[str, typer.Option(help="Case of the pictures.")] = "woodworking",
    joint: Annotated[int, typer.Option(help="Joint whose profiles are shown, counted from 1.", min=1)] = 1,
    readme: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Also put the answer, the table of papers and the law of growth between the marks `<!-- answer -->`, "
            "`<!-- papers -->` and `<!-- law -->` of this file, and what the audit of `study compare` found between `<!-- audit -->`.",
        ),
    ] = None,
    out: Out = DEFAULT_OUT,
) -> None:
    """Draw pictures of stored results: the ladder, one joint's profiles, the viewer's first look and its arms, moving."""
    cases, _, results = last_run(out)
    if case not in cases:
        raise StudyError(f"the last run in {out} was not of case {case!r}; it was of {', '.join(cases)}")
    if joint > cases[case].problem.n_joints:
        raise StudyError(f"case {case!r} has {cases[case].problem.n_joints} joints, got joint {joint}")
    summaries = {each.case.name: each for each in summarise(cases, results)}
    from study.comparison.build import said
    from study.recording import moving_picture, picture, record_case
    from study.report.pictures import (  # here: matplotlib and rerun are slow to import
        midway,
        pictures_of,
        small,
        write_pictures,
    )
    from study.report.readme import answer_in_markdown, put
    from study.reproduction.papers_table import papers_in_markdown
    from study.suites.law import law_in_markdown

    if readme is not None:
        put(readme, answer_in_markdown(list(summaries.values())))
        put(readme, papers_in_markdown(), "papers")
        put(readme, law_in_markdown([suite_named("scaling"), suite_named("scaling-second")]), "law")
        if sentences := said(out / STORE_NAME):
            put(readme, "\n".join(f"- {sentence}" for sentence in sentences), "audit")
    contents = pictures_of(summaries[case], joint - 1)
    recording = record_case(summaries[case], recording_file(out, case))
    contents["viewer.png"] = small(picture(recording, midway(summaries[case])))
    if cases[case].robot is not None:
        contents["arms.gif"] = moving_picture(summaries[case])
    for path in write_pictures(folder, case, contents):
        make_console().print(str(path))
