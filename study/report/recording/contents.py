"""What a recording shows: one entry per method, judged, coloured and sampled."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from study.curves import curve_named
from study.errors import StudyError
from study.experiment.cases import Case
from study.experiment.results import Result
from study.judge import Verdict, judge
from study.problem import Floats
from study.report.activity import Use, limit_uses
from study.trajectory import Motion

NANOSECOND = 1e-9

PALETTE = (
    (78, 166, 230),
    (255, 159, 64),
    (92, 200, 120),
    (238, 104, 104),
    (176, 136, 232),
    (222, 190, 80),
    (240, 130, 196),
    (64, 208, 208),
    (168, 208, 70),
    (186, 140, 108),
    (130, 150, 255),
    (255, 196, 150),
    (46, 160, 150),
    (214, 160, 230),
    (160, 160, 160),
    (230, 90, 150),
    (120, 190, 250),
    (200, 120, 50),
    (150, 230, 180),
    (220, 220, 130),
)
"""Colours that keep apart on the viewer's dark ground."""


@dataclass(frozen=True, eq=False)
class Entry:
    """One method on one case.

    Attributes
    ----------
    label : str
    color : tuple of three int
    motion : Motion, optional
    verdict : Verdict, optional
    uses : tuple of Use
        When which limit is active.
    result : Result, optional
        The run shown; None for what a paper prints.
    seeds, feasible : int
        Runs of this label, and how many of them the judge found feasible.
    remark : str
        Why there is no motion, or why it is infeasible.
    """

    label: str
    color: tuple[int, int, int]
    motion: Motion | None
    verdict: Verdict | None
    uses: tuple[Use, ...] = ()
    result: Result | None = None
    seeds: int = 1
    feasible: int = 0
    remark: str = ""

    @property
    def rank(self) -> tuple[int, float]:
        """Order in tables: feasible ones by duration, then infeasible ones, then those without a motion."""
        if self.verdict is None:
            return (2, 0.0)
        return (0 if self.verdict.feasible else 1, self.verdict.duration)


@dataclass(frozen=True, eq=False)
class Contents:
    """A case and its entries, the best feasible duration of all runs, and how finely motions are sampled.

    Attributes
    ----------
    case : Case
    entries : tuple of Entry
        In order of rank.
    best : float, s
        Shortest feasible duration of any run, infinite where there is none.
    samples : int
        Evenly spaced samples of every motion; its knots and exact peaks are added.
    """

    case: Case
    entries: tuple[Entry, ...]
    best: float
    samples: int

    @property
    def moving(self) -> tuple[tuple[Entry, Motion], ...]:
        """Entries that have a motion, each with it."""
        return tuple((entry, entry.motion) for entry in self.entries if entry.motion is not None)

    @property
    def longest(self) -> float:
        """Longest duration of any motion, s."""
        return max((motion.duration for _, motion in self.moving), default=1.0)


def gather(case: Case, results: Sequence[Result], samples: int) -> Contents:
    """Choose what to show: of every label the run in the middle of its ranks, and what the paper prints.

    Raises
    ------
    StudyError
        If a result belongs to another case, or there is nothing to show.
    """
    strangers = sorted({result.cell.case for result in results} - {case.name})
    if strangers:
        raise StudyError(
            f"recording of case {case.name!r}: got results of case {strangers[0]!r}; give one case's results"
        )
    labels = list(dict.fromkeys(result.cell.label for result in results))
    groups = {label: sorted((r for r in results if r.cell.label == label), key=_result_rank) for label in labels}
    found = printed_motion(case)
    printed = dict([found]) if found is not None and found[0] not in groups else {}
    if not groups and not printed:
        raise StudyError(f"recording of case {case.name!r}: no results; run the case first")
    colors = method_colors([*groups, *printed])
    entries = [_entry(case, group, colors[label]) for label, group in groups.items()]
    entries += [_printed_entry(case, label, motion, colors[label]) for label, motion in printed.items()]
    durations = [r.verdict.duration for r in results if r.verdict is not None and r.verdict.feasible]
    durations += [e.rank[1] for e in entries if e.rank[0] == 0]
    return Contents(
        case, tuple(sorted(entries, key=lambda e: (*e.rank, e.label))), min(durations, default=np.inf), samples
    )


def method_colors(labels: Sequence[str]) -> dict[str, tuple[int, int, int]]:
    """Give every method a colour of its own that depends on its name, so that it rarely changes between cases."""
    free = list(range(len(PALETTE)))
    colors: dict[str, tuple[int, int, int]] = {}
    for label in sorted(labels):
        wanted = int.from_bytes(hashlib.sha256(label.encode()).digest()[:4], "big") % len(PALETTE)
        slot = min(free, key=lambda k: (k - wanted) % len(PALETTE))
        colors[label] = PALETTE[slot]
        free.remove(slot)
        free = free or list(range(len(PALETTE)))
    return colors


def printed_motion(case: Case) -> tuple[str, Motion] | None:
    """Motion of the shortest total that the paper prints with durations for all joints together, with its label.

    Durations of single joints do not make a motion of the arm; durations that make no motion on the case's curve are
    passed over.
    """
    together = [(row.label, row.durations) for row in case.published if row.durations is not None and row.joint is None]
    for label, durations in sorted(together, key=lambda pair: float(pair[1].sum())):
        try:
            return f"published {label}", curve_named(case.curve).motion(case.problem.waypoints, durations)
        except StudyError:
            continue
    return None


def sample_times(motion: Motion, samples: int) -> np.ndarray:
    """Whole nanoseconds at which a motion is written down.

    Evenly spaced samples, the exact peaks of position, velocity, acceleration and jerk, and for every knot the last
    nanosecond before and the first after it, so that a step is drawn as a step.

    Parameters
    ----------
    motion : Motion
    samples : int

    Returns
    -------
    int64 array of shape (n_times,), ns
    """
    peaks = [times for order in range(4) for times in motion.extrema(order)[1::2]]
    end = int(np.floor(motion.duration / NANOSECOND))
    knots = np.floor(motion.knots / NANOSECOND)
    even = np.linspace(0.0, end, samples)
    times = np.concatenate([np.rint(even), knots, knots[:-1] + 1, np.rint(np.concatenate(peaks) / NANOSECOND)])
    return np.unique(np.clip(times, 0, end).astype(np.int64))


def seconds(times: np.ndarray) -> Floats:
    """Turn whole nanoseconds into seconds, the way a reader of the recording does."""
    return times * NANOSECOND


def _result_rank(result: Result) -> tuple[int, float, int]:
    verdict = result.verdict
    if verdict is None:
        return (2, 0.0, result.cell.settings.seed)
    return (0 if verdict.feasible else 1, verdict.duration, result.cell.settings.seed)


def _entry(case: Case, group: Sequence[Result], color: tuple[int, int, int]) -> Entry:
    shown = group[(len(group) - 1) // 2]
    feasible = sum(r.verdict is not None and r.verdict.feasible for r in group)
    uses = limit_uses(shown.motion, case.problem.limits) if shown.motion is not None else ()
    remark = "; ".join(shown.verdict.reasons) if shown.verdict is not None else shown.message or shown.status.value
    return Entry(shown.cell.label, color, shown.motion, shown.verdict, uses, shown, len(group), feasible, remark)


def _printed_entry(case: Case, label: str, motion: Motion, color: tuple[int, int, int]) -> Entry:
    verdict = judge(case.problem, motion)
    uses = limit_uses(motion, case.problem.limits)
    return Entry(label, color, motion, verdict, uses, None, 1, int(verdict.feasible), "; ".join(verdict.reasons))
