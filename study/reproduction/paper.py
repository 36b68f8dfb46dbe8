"""One paper as the reproduction sees it: its work, its rulings and its figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar, Protocol

import numpy as np

from study.cases.library import load_case
from study.cases.printed import Cell, Table
from study.cases.published import Claim, claims, tables
from study.problem import Floats
from study.reproduction import convergence
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.effort import Effort
from study.reproduction.jobs import Record, RecordJob, Runs
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, summarised, synchronised
from study.reproduction.sampling import Comparison, compared, in_every
from study.reproduction.verdicts import Basis, Outcome, Place, Ruling, Rulings

JobOf = Callable[[int], RecordJob]
"""Job of a joint."""


@dataclass(frozen=True)
class Panel:
    """One small plot: lines over generations.

    Attributes
    ----------
    title : str
    lines : mapping of a label to generations and values
    logarithmic : bool
        Whether values span orders of magnitude.
    marks : mapping of a label to its printed value
    least : float, optional
        The optimum.
    """

    title: str
    lines: Mapping[str, tuple[Sequence[float], Sequence[float]]]
    logarithmic: bool = False
    marks: Mapping[str, float] = field(default_factory=dict)
    least: float | None = None


@dataclass(frozen=True, eq=False)
class Drive:
    """Motions of a case to draw: labels and segment durations, shape (n_segments,), s."""

    case: str
    motions: Sequence[tuple[str, Floats]]


def line_of(record: Record) -> tuple[Sequence[float], Sequence[float]]:
    """Median best value against generations of a job's record."""
    return record["generations"], record["curve"]


class Paper(Protocol):
    """Work, rulings and figures that the reproduction asks of a paper."""

    key: ClassVar[str]
    short: ClassVar[str]
    maps: ClassVar[tuple[str, ...]]
    map_numbers: ClassVar[int]

    def __init__(self, effort: Effort, runs: Runs) -> None:
        """Take the effort, and the records of the jobs; none are needed to name the jobs."""

    def jobs(self) -> list[RecordJob]:
        """All work that the paper's page needs."""

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""

    def panels(self) -> list[Panel]:
        """Convergence on the arm."""

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion."""


@dataclass(frozen=True)
class PaperRuns:
    """Effort and records of one paper, and what every paper's rulings need of them.

    Attributes
    ----------
    effort : Effort
    runs : Runs
    """

    effort: Effort
    runs: Runs
    key: ClassVar[str]
    short: ClassVar[str]
    maps: ClassVar[tuple[str, ...]] = ()
    map_numbers: ClassVar[int] = 1000

    @property
    def tables(self) -> dict[str, Table]:
        """Printed tables by number."""
        return tables(self.key)

    @property
    def claims(self) -> dict[str, Claim]:
        """Printed numbers of the prose by id."""
        return claims(self.key)

    @property
    def benchmarks(self) -> BenchmarkTable:
        """The paper's benchmark table with our runs of it."""
        return BenchmarkTable(self.key, self.effort, self.runs)

    def fastest(self, case: str, joint: int | None = None) -> float:
        """Shortest duration on the paper's curve, s, by the deterministic reference."""
        return float(self.runs[OptimumJob(case, joint)]["total"])

    def line(self, job: RecordJob) -> tuple[Sequence[float], Sequence[float]]:
        """Median best value against generations of a job's record."""
        return line_of(self.runs[job])

    def timed(self, case: str, jobs: Sequence[MotionJob], joint: int | None = None) -> Summary | None:
        """Our feasible runs: of one job, or of one job for each joint put together as the papers do."""
        records = [self.runs[job] for job in jobs]
        per_seed = np.array(records[0]["durations"]) if len(jobs) == 1 else synchronised(records)
        return summarised(load_case(case), per_seed, joint)

    def shorter(self, first: Summary | None, second: Summary | None) -> Comparison:
        """Compare the totals of our feasible runs of two searches."""
        return compared(*(self.totals(ours) or [np.inf] for ours in (first, second)))

    def panel(
        self, case: str, jobs: Mapping[str, RecordJob], marks: Mapping[str, float], joint: int | None = None
    ) -> Panel:
        """Convergence of several searches on a joint, or on all together, with the printed values and the optimum."""
        title = "all joints, total time in s" if joint is None else f"joint {joint + 1}"
        lines = {name: self.line(job) for name, job in jobs.items()}
        return Panel(title, lines, marks=marks, least=self.fastest(case, joint))

    def drive(
        self, case: str, printed: Floats, label: str, ours: Summary | None, before: Floats | None = None
    ) -> Drive:
        """Motion before, printed, ours and fastest, of all joints together."""
        start = [] if before is None else [("before, as printed", before)]
        own = [] if ours is None else [(f"{label}, ours", ours.durations)]
        fastest = np.array(self.runs[OptimumJob(case)]["durations"])
        return Drive(case, [*start, ("printed", printed), *own, ("fastest on this curve", fastest)])

    def totals(self, ours: Summary | None) -> list[float]:
        """Totals of our feasible runs, s; none where no run is feasible."""
        return [] if ours is None else list(ours.totals)

    def told(self, summaries: Mapping[str, Summary | None]) -> dict[str, str]:
        """Medians under other readings as text."""
        return {
            name: "no feasible run" if summary is None else f"{summary.total:.4f} s"
            for name, summary in summaries.items()
        }

    def placed(self, table: str, ruled: Sequence[tuple[Cell, Ruling]], others: Mapping[str, str]) -> Rulings:
        """Place the rulings of a row of durations, other readings beside its total."""
        return {
            Place(table, cell.row, cell.column): replace(
                ruling, others=others if ruling.outcome is not Outcome.PART else {}
            )
            for cell, ruling in ruled
        }

    def fitted(self, ruling: Ruling) -> Ruling:
        """Say of a ruling by runs that its constants were chosen on the paper's own table."""
        return replace(ruling, basis=Basis.FITTED)

    def steps(self, records: Sequence[Record]) -> str:
        """Slowest of our medians until convergence at the four shares of the descent, as text."""
        return " / ".join(f"{steps:g}" for steps in convergence.slowest(records).values())

    def everywhere(self, first: JobOf, second: JobOf, subjects: Sequence[int], most: bool = False) -> Ruling:
        """Rule on the statement that one search converges before another on every joint, or on most of them."""

        def tests(level: str) -> dict[str, Comparison]:
            both = {j: [self.runs[job(j)]["settled"][level] for job in (first, second)] for j in subjects}
            return {f"joint {j + 1}": compared(*pair) for j, pair in both.items()}

        ruling, won = at_any_share(tests)
        if most and won > len(subjects) / 2:
            return replace(ruling, outcome=Outcome.REPRODUCED, agrees=True)
        return ruling


def at_any_share(tests: Callable[[str], Mapping[str, Comparison]]) -> tuple[Ruling, int]:
    """Rule on a statement about convergence, and count the tests won.

    The share of the descent at which the statement holds most often decides; all of them are shown.

    Parameters
    ----------
    tests : callable (name of a share) -> mapping of str to Comparison
    """
    rulings = {level: in_every(tests(level)) for level in convergence.LEVELS}
    won = {level: int(ruling.ours.split(" ")[0]) for level, ruling in rulings.items()}
    best = max(won, key=lambda level: won[level])
    text = "; ".join(f"{ruling.ours.removesuffix(' comparisons')} at {level}" for level, ruling in rulings.items())
    return replace(rulings[best], ours=text, why=f"at {best} of the descent: {rulings[best].why}"), won[best]
