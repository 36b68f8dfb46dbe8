"""The planner's two tiers next to other packages on problems of real arms: durations and processor time, in one run.

The peers are those that are registered. What is timed is the package's own work, without making its answer exact. A peer's motion that breaks a limit of rates is slowed down by the smallest exact factor; what the judge then passes is
usable. The best peer of a problem is the one with the shortest usable motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import geometric_mean, median
from typing import Any, Protocol, cast

import numpy as np

from study.api import plan
from study.bench.measuring import timed
from study.judge import judge
from study.problem import Problem
from study.registry import peer_names, planner_named, unavailable_planners
from study.suites.tasks import arm_problems
from study.trajectory import Motion

REPETITIONS = 3
CLOSE, MEAN, FAST = 1.001, 0.945, 2.0
"""Targets: the worst and the mean ratio of *best* to the best peer's duration, and of *fast* to a path timing's cost."""


TIMINGS = ("toppra-natural", "toppra-centripetal", "copp-topp3")

LIMIT = 60.0
"""Seconds that a peer has, as far as it can be stopped."""

LONG = 5.0
"""Processor time of a first call, s, beside which what it loads does not matter, so that it is not repeated."""


class Peer(Protocol):
    """Another package's way to plan, in two steps, as `baselines.peers` has them."""

    outside: bool

    def declines(self, problem: Problem, time_limit: float) -> str:
        """Say why the package is not asked; empty where it is."""

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Ask the package."""

    def motion(self, problem: Problem, answer: Any) -> Motion:
        """Make an exact motion of its answer."""


def timed_peers() -> dict[str, Peer]:
    """Installed peers whose work is done in this process, which alone is measured."""
    broken = unavailable_planners()
    peers = {name: cast(Peer, planner_named(name)) for name in peer_names() if name not in broken}
    return {name: peer for name, peer in peers.items() if not getattr(peer, "outside", True)}


@dataclass(frozen=True)
class Answer:
    """A planner's motion of one problem.

    Attributes
    ----------
    name : str
    duration : float, s
        Of the motion as it may be driven; infinite where there is none.
    stretch : float
        By how much it had to be slowed down.
    seconds : float
        Processor time, the median of all repetitions.
    """

    name: str
    duration: float
    stretch: float
    seconds: float


@dataclass(frozen=True)
class Row:
    """Answers to one problem."""

    problem: str
    fast: Answer
    best: Answer
    peers: tuple[Answer, ...]

    @property
    def peer(self) -> Answer:
        """The peer with the shortest motion, and of equal ones the quickest."""
        shortest = min(answer.duration for answer in self.peers)
        level = [answer for answer in self.peers if answer.duration <= shortest * (1 + 1e-9)]
        return min(level, key=lambda answer: answer.seconds)

    @property
    def ratio(self) -> float:
        """Duration of *best* by the best peer's."""
        return self.best.duration / self.peer.duration

    @property
    def timing(self) -> Answer | None:
        """The quickest path timing that *fast* is measured against: TOPP-RA at constant acceleration, or COPP's third order."""
        kinds = [answer for answer in self.peers if answer.name.startswith(TIMINGS)]
        return min(kinds, key=lambda answer: answer.seconds, default=None)


def arm_rows(seed: int, told: Callable[[str], None], wanted: Sequence[str] = ()) -> list[Row]:
    """Ask the tiers and all peers that are installed, problem by problem; `wanted` names parts of problems' names."""
    rows = []
    for problem in arm_problems(seed):
        if not wanted or any(part in problem.name for part in wanted):
            rows.append(_row(problem))
            told(said(rows[-1]))
    return rows


def _row(problem: Problem) -> Row:
    answers = [_peer(problem, *each) for each in timed_peers().items() if not each[1].declines(problem, LIMIT)]
    return Row(problem.name, _tier(problem, "fast"), _tier(problem, "best"), tuple(answers))


def _timed(call: Callable[[], object]) -> tuple[object, float]:
    """Answer of a call, and its median processor time, s; a short first call does not count, for it loads what it needs."""
    first = timed(call, 1)
    return first if first[1] > LONG else timed(call, REPETITIONS)


def _tier(problem: Problem, name: str) -> Answer:
    _, seconds = _timed(lambda: plan(problem, name))
    return Answer(name, plan(problem, name).duration, 1.0, seconds)


def _peer(problem: Problem, name: str, peer: Peer) -> Answer:
    try:
        answer, seconds = _timed(lambda: peer.solve(problem, LIMIT))
        motion = None if answer is None else peer.motion(problem, answer)
    except Exception:  # a stranger's package may raise anything to say no
        motion = None
    if motion is None:
        return Answer(name, np.inf, 1.0, np.nan)
    stretch = judge(problem, motion).stretch
    slowed = motion.scaled(stretch)
    usable = judge(problem, slowed).feasible
    return Answer(name, slowed.duration if usable else np.inf, stretch, seconds)


def said(row: Row) -> str:
    """One row in a line."""
    peer, timing = row.peer, row.timing
    against = "" if timing is None else f", {timing.name} {timing.seconds * 1e3:.1f} ms"
    return (
        f"{row.problem}: fast {row.fast.duration:.4f} s, {row.fast.seconds * 1e3:.1f} ms{against}; best "
        f"{row.best.duration:.4f} s, {row.best.seconds * 1e3:.1f} ms; {peer.name} {peer.duration:.4f} s, "
        f"{peer.seconds * 1e3:.1f} ms; best / peer {row.ratio:.4f}"
    )


def summary(rows: Sequence[Row]) -> list[str]:
    """Sentences on the targets."""
    ratios = [row.ratio for row in rows]
    ours, theirs = median(row.best.seconds for row in rows), median(row.peer.seconds for row in rows)
    worst = max(rows, key=lambda row: row.ratio)
    texts = [
        f"best against the best usable peer: geometric mean {geometric_mean(ratios):.4f} (target at most {MEAN}), worst "
        f"{worst.ratio:.4f} on {worst.problem} (target at most {CLOSE})",
        f"median processor time: best {ours * 1e3:.1f} ms, the best peers {theirs * 1e3:.1f} ms (target below)",
        f"best is never above fast: {all(row.best.duration <= row.fast.duration for row in rows)}",
    ]
    for kind, jerky in (("toppra, v+a", False), ("COPP's third order, v+a+j", True)):
        shares = [
            row.fast.seconds / row.timing.seconds
            for row in rows
            if row.timing is not None and row.timing.name.startswith("copp") is jerky
        ]
        if shares:
            texts.append(f"fast by {kind}: median {median(shares):.2f}, most {max(shares):.2f} (target at most {FAST})")
    return texts
