"""The performance page of the report, made from the JSON of a bench and nothing else."""

from __future__ import annotations

from pathlib import Path

from study.bench import figures, wording
from study.bench.run import Bench, read
from study.files import write_file
from study.report.rendering import render, write_scripts


def write_page(record: Path, out: Path) -> Path:
    """Write `performance.html`.

    Parameters
    ----------
    record : Path
        What `study bench --out` wrote.
    out : Path
        Folder of the report, made if need be.

    Returns
    -------
    Path
        The page.

    Raises
    ------
    StudyError
        If the record cannot be read or the page cannot be written.
    """
    bench = read(record)
    page = out / "performance.html"
    write_scripts(out)
    return write_file(page, _render(bench))


def _render(bench: Bench) -> str:
    context = {
        "answer": wording.summary(bench),
        "reading": wording.READING,
        "head": wording.HEAD,
        "topics": [(topic, [wording.cells(row) for row in rows]) for topic, rows in wording.topics(bench.rows)],
        "growth": figures.growth(bench.growth),
        "styles": figures.styles(bench.growth),
        "points": bench.growth,
        "label": figures.label,
        "environment": bench.environment,
    }
    return render("performance.html.j2", context, package="study.bench")
