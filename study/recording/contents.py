"""Contents of a recording: every method of a case, judged, coloured and sampled."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from study.analysis.activity import Use, limit_uses
from study.analysis.case_summary import CaseSummary
from study.analysis.featured import Featured
from study.analysis.methods import Kind, MethodSummary
from study.analysis.palette import rgb
from study.cases.library import Case
from study.errors import StudyError
from study.planning import Freedom
from study.problem import Floats, JointLimits
from study.trajectory import Extrema, Motion

NANOSECOND = 1e-9
FIRST_LOOK = 6
"""Number of arms that the first look has room for."""

FEW = 3
"""Fewer featured methods than this are joined by the next in rank."""

_COLORS = (
    "4ea6e6 ff9f40 5cc878 ee6868 b088e8 debe50 f082c4 40d0d0 a8d046 ba8c6c 8296ff ffc496 2ea096 d6a0e6 "
    "a0a0a0 e65a96 78befa c87832 96e6b4 dcdc82 6e6ebe be3c3c 508c3c fa786e bec8e6 9650a0 64e6f0 a06e50"
)
PALETTE = tuple((red, green, blue) for red, green, blue in map(bytes.fromhex, _COLORS.split()))
"""Colours that keep apart on the viewer's dark ground."""


@dataclass(frozen=True, eq=False)
class Shown:
    """A motion that the recording shows, and the method it belongs to.

    Attributes
    ----------
    method : MethodSummary
    motion : Motion
        Of the method's representative run.
    color : tuple of three int
    limits : JointLimits
    """

    method: MethodSummary
    motion: Motion
    color: tuple[int, int, int]
    limits: JointLimits

    @cached_property
    def uses(self) -> tuple[Use, ...]:
        """Intervals in which each limit is active."""
        return limit_uses(self.motion, self.limits, extrema=self.extrema[1:])

    @cached_property
    def extrema(self) -> tuple[Extrema, ...]:
        """Peaks of position, velocity, acceleration and jerk."""
        return tuple(self.motion.extrema(order) for order in range(4))

    def times(self, samples: int) -> np.ndarray:
        """Whole nanoseconds at which the motion is written down, shape (n_times,); see `sample_times`."""
        return sample_times(self.motion, samples, self.extrema)

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.method.label

    @property
    def feasible(self) -> bool:
        """True where the motion shown passed the judge."""
        run = self.method.representative
        return run is not None and run.feasible

    @property
    def published(self) -> bool:
        """True for a motion that the paper prints."""
        return self.method.kind is Kind.PUBLISHED

    @property
    def title(self) -> str:
        """Time, whether the motion is infeasible, and the name, which may be long and is cut off where room is short."""
        return f"{self.motion.duration:.3f} s{'' if self.feasible else ' infeasible'}  {self.label}"


@dataclass(frozen=True, eq=False)
class Contents:
    """A case, its methods in order of rank and the motions shown.

    Attributes
    ----------
    summary : CaseSummary
    shown : tuple of Shown
        Methods with a motion; of what the paper prints only the shortest.
    best : float, s
        Shortest feasible duration of any run on the paper's curve, infinite where there is none.
    samples : int
        Evenly spaced samples of every motion; its knots and exact peaks are added.
    """

    summary: CaseSummary
    shown: tuple[Shown, ...]
    best: float
    samples: int

    @property
    def case(self) -> Case:
        """The case itself."""
        return self.summary.case

    @property
    def methods(self) -> tuple[MethodSummary, ...]:
        """Methods in order of rank; single joints are left out."""
        return self.summary.whole

    @property
    def chosen(self) -> Featured:
        """The best method of every role, for the first look."""
        return self.summary.best

    @property
    def longest(self) -> float:
        """Longest duration of any motion, s."""
        return max((each.motion.duration for each in self.shown), default=1.0)

    @property
    def run_time(self) -> float:
        """Duration of the first look's longest motion, s."""
        return max((each.motion.duration for each in self.compared), default=1.0)

    @property
    def first_look(self) -> tuple[Shown, ...]:
        """The featured methods and, where they are few, the next in rank; where they are many, no fixed path."""
        others = [each for each in self.shown if each not in self.featured]
        fixed = self.chosen.fixed.label if self.chosen.fixed is not None else ""
        kept = [each for each in self.featured if len(self.featured) <= FIRST_LOOK or each.label != fixed]
        picked = [*kept, *others][:FIRST_LOOK]
        return tuple(each for each in self.shown if each in picked)

    @property
    def featured(self) -> tuple[Shown, ...]:
        """The best method of every kind, the paper's own planner and what the paper prints, in order of rank."""
        labels = {method.label for _, _, method in self.chosen.present()} | {self.case.planner}
        return tuple(each for each in self.shown if each.label in labels or each.published)

    @property
    def compared(self) -> tuple[Shown, ...]:
        """Featured methods, or the first look's where they are few, that fit into one plot.

        No infeasible ones but the published, and none far slower.
        """
        wanted = [each for each in self.first_look if each in self.featured or len(self.featured) < FEW]
        judged = [each for each in wanted if each.feasible or each.published]
        reference = self.chosen.reference
        slowest = 2.5 * (reference.duration or np.inf) if reference is not None else np.inf
        return tuple(each for each in judged if each.motion.duration <= slowest) or self.first_look


def gather(summary: CaseSummary, samples: int) -> Contents:
    """Choose the motions to show of a case.

    Raises
    ------
    StudyError
        If there is nothing to show.
    """
    case, methods = summary.case, summary.whole
    if not methods:
        raise StudyError(f"recording of case {case.name!r}: no results; run the case first")
    moving = [(method, method.motion) for method in methods if method.motion is not None]
    printed = sorted((pair for pair in moving if pair[0].kind is Kind.PUBLISHED), key=lambda pair: pair[1].duration)[:1]
    moving = [pair for pair in moving if pair[0].kind is not Kind.PUBLISHED or pair in printed]
    shown = tuple(
        Shown(method, motion, rgb(summary.slots[method.label]), case.problem.limits) for method, motion in moving
    )
    on_curve = [m.best for m in methods if m.best is not None and m.freedom is Freedom.CURVE]
    return Contents(summary, shown, min(on_curve, default=np.inf), samples)


def sample_times(motion: Motion, samples: int, extrema: Sequence[Extrema] = ()) -> np.ndarray:
    """Whole nanoseconds at which a motion is written down.

    Evenly spaced samples, the exact peaks of position, velocity, acceleration and jerk, and every knot with a
    nanosecond before and one after it, so that a step is drawn as a step.

    Parameters
    ----------
    motion : Motion
    samples : int
    extrema : sequence of Extrema, optional
        Of position, velocity, acceleration and jerk, where they are known already.

    Returns
    -------
    int64 array of shape (n_times,), ns
    """
    peaks = [times for extreme in extrema or map(motion.extrema, range(4)) for times in extreme[1::2]]
    end = int(np.floor(motion.duration / NANOSECOND))
    knots = np.rint(motion.knots / NANOSECOND)
    even = np.linspace(0.0, end, samples)
    times = np.concatenate([np.rint(even), knots - 1, knots, knots + 1, np.rint(np.concatenate(peaks) / NANOSECOND)])
    return np.unique(np.clip(times, 0, end).astype(np.int64))


def in_seconds(times: np.ndarray) -> Floats:
    """Turn whole nanoseconds into seconds, the way a reader of the recording does."""
    return times * NANOSECOND
