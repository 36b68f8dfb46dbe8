"""Answers of `plan` and `compare`: the motion or motions, what the judge says, and ways to show, hand on and write them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from study.arrays import of_kind
from study.cautions import cautions
from study.errors import StudyError
from study.files import named
from study.io.export import controller_points, write_motion
from study.io.samples import Samples
from study.io.sampling import Sampling
from study.judge import Verdict
from study.path_findings import largest_deviation
from study.planning import Status, single_move
from study.problem import Problem
from study.runs.selections import DIRECT
from study.slowing import SLOWED, slowed_said
from study.store.results import Result
from study.trajectory import Motion

if TYPE_CHECKING:
    from study.notebook.figures import Drawing

STILL = 1e-9
"""Share of a joint's largest speed below which the joint stands still."""


@dataclass(frozen=True, eq=False, repr=False)
class Planned:
    """Answer of `plan`.

    Attributes
    ----------
    problem : Problem
    result : Result
        The fastest feasible motion of all that were tried, else the one that breaks the limits least.
    tried : tuple of (str, str, Result)
        Planners in the order in which they ran, how each works, and its result.
    tier : str
        The tier that was asked for; empty where it was a planner.
    spared : mapping of str to float
        Planners that did not run, and the times, s, that their motions are known to take at least.
    """

    problem: Problem
    result: Result
    tried: tuple[tuple[str, str, Result], ...]
    tier: str = ""
    spared: Mapping[str, float] = field(default_factory=dict)

    @property
    def planner(self) -> str:
        """Name of the planner whose answer it is."""
        return self.result.cell.planner

    @property
    def why(self) -> str:
        """Reason why this motion is the answer, and why it stops at every waypoint where it does."""
        if not self.tier:
            lead = "it was asked for"
        elif not self.feasible:
            return "no motion keeps the limits, and this one breaks them least"
        elif self.planner in DIRECT and single_move(self.problem):
            lead = "no move from rest to rest is faster"
        elif (count := sum(not result.reason for _, _, result in self.tried)) > 1:
            lead = f"the fastest of {count} feasible motions"
        elif self.tier == "fast":
            lead = "the first feasible motion"
        elif self.spared:
            others = (f"{name} takes at least {least:.4g} s" for name, least in self.spared.items())
            lead = f"the fastest of all, for {' and '.join(others)}"
        else:
            lead = "the only feasible motion that was found"
        about = next((about for name, about, _ in self.tried if name == self.planner), "")
        slowed = slowed_said(self.problem, self.result.details.get(SLOWED))
        return f"{lead}: {about}{slowed and '; '}{slowed}{self._stopping}"

    @property
    def _stopping(self) -> str:
        if not (self.feasible and stops_everywhere(self.problem, self.motion)):
            return ""
        others = [f"{name}: {result.reason}" for name, _, result in self.tried if result.reason]
        return f"; it stops at every waypoint, because {'; '.join(others) or 'nothing that was tried is faster'}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences to be read before the motion is driven: missing limits, and time limits that were reached."""
        late = [f"{n}: {r.message or r.status.value}" for n, _, r in self.tried if r.status is Status.TIMED_OUT]
        return (*cautions(self.problem), *late)

    def __repr__(self) -> str:
        end = (
            f"{self.duration:.6g} s by {self.planner}, feasible, at most {self.deviation:.4g} rad or m from the straight lines"
            if self.feasible
            else f"no feasible motion: {self.reason}"
        )
        tried = ", ".join(name for name, _, _ in self.tried)
        warned = "; ".join(self.warnings) or "none"
        return f"Planned {self.problem.name!r}: {end}\ntried: {tried}\nwarnings: {warned}"

    @property
    def feasible(self) -> bool:
        """True where the judge passed the motion."""
        return self.result.feasible

    @property
    def motion(self) -> Motion:
        """The motion, feasible or not.

        Raises
        ------
        StudyError
            If no planner gave one.
        """
        if self.result.motion is None:
            raise StudyError(f"case {self.problem.name!r}: {self.reason}")
        return self.result.motion

    @property
    def verdict(self) -> Verdict:
        """Verdict of the judge.

        Raises
        ------
        StudyError
            If there is no motion to judge.
        """
        if self.result.verdict is None:
            raise StudyError(f"case {self.problem.name!r}: {self.reason}")
        return self.result.verdict

    @property
    def duration(self) -> float:
        """Total time, s; infinite where there is no feasible motion."""
        return self.verdict.duration if self.feasible else np.inf

    @cached_property
    def deviation(self) -> float:
        """Largest distance of any joint from the straight lines between waypoints, rad or m.

        Raises
        ------
        StudyError
            If there is no motion.
        """
        return largest_deviation(self.problem, self.motion)

    @property
    def reason(self) -> str:
        """Why there is no feasible motion, one sentence; empty where there is one."""
        return self.result.reason

    def points(
        self,
        rate: float | None = None,
        points: int | None = None,
        *,
        accept_unbounded_acceleration: bool = False,
    ) -> Samples:
        """Points for a controller object: names, times and rates; see `study.io.export.controller_points`.

        Raises
        ------
        StudyError
            If a joint that moves has no acceleration limit and that is not accepted, or rate or number are impossible.
        """
        accepted = of_kind(accept_unbounded_acceleration, bool, "accept_unbounded_acceleration")
        return controller_points(
            self.motion, self.problem, Sampling(rate, points), accept_unbounded_acceleration=accepted
        )

    def write(
        self,
        path: str | Path,
        rate: float | None = None,
        points: int | None = None,
        *,
        accept_unbounded_acceleration: bool = False,
    ) -> Path:
        """Write the motion in the form that the file's name asks for; see `study.io.export.write_motion`.

        Raises
        ------
        StudyError
            If the file cannot be written, or a joint that moves has no acceleration limit and that is not accepted.
        """
        accepted, sampling = accept_unbounded_acceleration, Sampling(rate, points)
        of_kind(accepted, bool, "accept_unbounded_acceleration")
        return write_motion(self.motion, self.problem, named(path), sampling, accept_unbounded_acceleration=accepted)

    def _repr_html_(self) -> str:
        from study.notebook.cards import card_of_plan  # here: matplotlib is slow to import

        return card_of_plan(self.problem, self.result, self.why, self.warnings)

    def plot(self, joint: str | int | None = None) -> Drawing:
        """Draw position, velocity, acceleration and jerk over time, against their limits.

        Parameters
        ----------
        joint : str or int, optional
            Name of a joint, or its place counted from 0: this one alone, in its own units. All joints by default, rates in
            percent of their limits.

        Returns
        -------
        matplotlib.figure.Figure
            Which a notebook draws by itself; `savefig` writes it.

        Raises
        ------
        StudyError
            If there is no motion, or no such joint.
        """
        from study.notebook.figures import drawing, drawing_of_joint  # here: matplotlib is slow to import

        if joint is None:
            return drawing(self.problem, self.motion)
        return drawing_of_joint(self.problem, self.motion, joint)

    def show(self, file: str | Path | None = None, robot: str | Path | None = None) -> Path:
        """Record all motions that were tried and show them in the rerun viewer: in place in a notebook, else in a window.

        Where neither can be had, one sentence says why, and the recording is there all the same.

        Parameters
        ----------
        file : str or Path, optional
            The recording; by default the problem's name with the ending `.rrd`, in this folder.
        robot : str or Path, optional
            An arm that the study knows, or a URDF file, to see it move.

        Returns
        -------
        Path
            The recording.

        Raises
        ------
        StudyError
            If it cannot be written, or the arm has other joints than the problem.
        """
        from study.notebook.showing import shown  # here: rerun is slow to import

        return shown(self.problem, [result for _, _, result in self.tried], file, robot)


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """Answer of `compare`: one result for each planner and seed, feasible ones first, then by duration."""

    problem: Problem
    results: tuple[Result, ...]

    @property
    def best(self) -> Result | None:
        """Fastest feasible result; None where there is none."""
        first = self.results[0]
        return first if first.feasible else None

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences to be read before any of the motions is driven."""
        return cautions(self.problem)

    def __str__(self) -> str:
        return "\n".join([*self.warnings, *_lines(self.results)])

    def _repr_html_(self) -> str:
        from study.notebook.cards import table_of_comparison

        return table_of_comparison(self.problem, self.results, self.warnings)

    def __repr__(self) -> str:
        count, best = sum(not result.reason for result in self.results), self.best
        fastest = f"{best.cell.label}, {best.duration:.6g} s" if best else "none"
        lead = f"Comparison on {self.problem.name!r}: {len(self.results)} runs, {count} feasible"
        return f"{lead}\nfastest feasible: {fastest}\nwarnings: {'; '.join(self.warnings) or 'none'}"


def stops_everywhere(problem: Problem, motion: Motion) -> bool:
    """Tell if a motion rests at every waypoint between the ends."""
    if problem.n_waypoints < 3:
        return False
    speeds = np.abs(motion(motion.waypoint_times[1:-1], 1))
    return bool((speeds <= STILL * motion.extrema(1).peak).all())


def _lines(results: Sequence[Result]) -> Iterator[str]:
    width = max(len(result.cell.label) for result in results)
    for result in results:
        duration = "" if result.verdict is None else f"{result.verdict.duration:.5g} s"
        seed = f"seed {result.cell.settings.seed}" if result.evaluations else ""
        said = result.reason or "feasible"
        yield f"{result.cell.label:<{width}}  {duration:>12}  {seed:<8}  {said}".rstrip()
