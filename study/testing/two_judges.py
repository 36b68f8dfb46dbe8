"""Two judges on the same motions: random ones, and ones made to fool a judge."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass

from study.judge import judge
from study.problem import Problem
from study.testing.attacks import adversarial
from study.testing.second_judge import Answer, second_judge
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory

BAND = 1e-8
"""Width of the band around the tolerance in which both answers are right, for the first judge's largest excess."""

AGREEMENTS = ("feasible", "infeasible", "in the band", "undecided", "different")
"""Possible agreements of two judges; the last must not happen."""

BLOCK = 200
"""Motions that a worker judges at a time."""


@dataclass(frozen=True)
class Agreement:
    """Agreement of two judges on many motions.

    Attributes
    ----------
    counts : Counter of (str, str)
        Attack and what came of it, one of `AGREEMENTS`.
    different : tuple of str
        A sentence for each motion on which the judges differ.
    """

    counts: Counter[tuple[str, str]]
    different: tuple[str, ...]

    def total(self, outcome: str) -> int:
        """Motions of all attacks with this outcome."""
        return sum(count for (_, came), count in self.counts.items() if came == outcome)


def compare_judges(
    motions: int, seed: int, jobs: int = 1, on_block: Callable[[int], None] = lambda motions: None
) -> Agreement:
    """Put random and adversarial motions to both judges.

    Parameters
    ----------
    motions : int
    seed : int
    jobs : int
        Worker processes; one works in this process.
    on_block : callable, optional
        Told how many motions more have been judged.
    """
    blocks = [(seed, first, min(first + BLOCK, motions)) for first in range(0, motions, BLOCK)]
    counts: Counter[tuple[str, str]] = Counter()
    different: list[str] = []
    pool = ProcessPoolExecutor(jobs) if jobs > 1 else None
    try:
        for block, agreement in zip(blocks, (pool.map if pool else map)(_judged_twice, blocks), strict=True):
            counts += agreement.counts
            different += agreement.different
            on_block(block[2] - block[1])
    finally:
        if pool:
            pool.shutdown(cancel_futures=True)
    return Agreement(counts, tuple(different))


def _judged_twice(block: tuple[int, int, int]) -> Agreement:
    """Judge the motions of a seed from one number up to another."""
    seed, first, last = block
    counts: Counter[tuple[str, str]] = Counter()
    different = []
    for number in range(first, last):
        attack, problem, motion = adversarial(seed, number)
        outcome, sentence = _outcome(problem, motion)
        counts[attack, outcome] += 1
        if sentence:
            different.append(f"motion {seed}/{number} ({attack}): {sentence}")
    return Agreement(counts, tuple(different))


def _outcome(problem: Problem, motion: Trajectory) -> tuple[str, str]:
    verdict, second = judge(problem, motion), second_judge(problem, motion)
    if second.answer is Answer.UNDECIDED:
        return "undecided", ""
    if abs(verdict.violation - TOLERANCE) <= BAND:
        return "in the band", ""
    if verdict.feasible == (second.answer is Answer.FEASIBLE):
        return second.answer.value, ""
    said = "; ".join(verdict.reasons) or "feasible"
    return "different", f"the first says {said}, the second an excess of {second.low:.3g} to {second.high:.3g}"
