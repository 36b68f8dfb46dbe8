"""Interleaved measurements of processor time, and the ratios that come of them.

Processor time of this process, not wall time: other work on the machine then disturbs caches but is not counted. The
calls of one comparison take turns within each repetition, so that a slow minute hits all of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

Call = Callable[[], object]
SHORTEST = 0.02
"""Seconds that one measured stretch lasts at least; quicker calls are repeated within it."""


@dataclass(frozen=True)
class Measurement:
    """Times of one thing over repetitions, beside a peer's, an allowance, or nothing.

    Attributes
    ----------
    topic, name, peer : str
        Part of the study, what was measured, and whom it was measured against; an empty peer stands alone.
    unit : str
        What the seconds are for, such as `evaluation`.
    seconds, peer_seconds : tuples of float
        Processor seconds of each repetition.
    target : float, optional
        Ratio of the peer's time to ours that the project has set itself.
    missing : str
        Why there is no measurement.
    most : float, optional
        Seconds that the project allows itself.
    """

    topic: str
    name: str
    peer: str
    unit: str
    seconds: tuple[float, ...] = ()
    peer_seconds: tuple[float, ...] = ()
    target: float | None = None
    missing: str = ""
    most: float | None = None

    @property
    def ratios(self) -> tuple[float, ...]:
        """Peer's seconds by ours, for each repetition."""
        return tuple(theirs / ours for ours, theirs in zip(self.seconds, self.peer_seconds, strict=True))

    @property
    def middle(self) -> float:
        """Median ratio; not a number without a peer."""
        return median(self.ratios) if self.peer_seconds else float("nan")

    @property
    def met(self) -> bool | None:
        """Whether the median reaches the target or keeps the allowance; none without either, or without a measurement."""
        if self.most is not None:
            return median(self.seconds) <= self.most
        return None if self.target is None or not self.peer_seconds else self.middle >= self.target


def interleaved(calls: Mapping[str, Call], repetitions: int, counts: Mapping[str, int]) -> dict[str, tuple[float, ...]]:
    """Measure calls by turns.

    Parameters
    ----------
    calls : mapping of str to callable
        Each is called once before anything is measured.
    repetitions : int
    counts : mapping of str to int
        How many units one call works off.

    Returns
    -------
    dict of str to tuple of float
        Processor seconds per unit of every repetition.
    """
    loops = {name: _loops(call) for name, call in calls.items()}
    taken: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(repetitions):
        for name, call in calls.items():
            taken[name].append(_seconds(call, loops[name]) / (loops[name] * counts[name]))
    return {name: tuple(values) for name, values in taken.items()}


def _loops(call: Call) -> int:
    """Number of repeated calls that fill the shortest measurement; the first call also warms up."""
    call()
    once = _seconds(call, 1)
    return max(1, round(SHORTEST / max(once, 1e-7)))


def _seconds(call: Call, loops: int) -> float:
    begun = time.process_time()
    for _ in range(loops):
        call()
    return time.process_time() - begun


def timed(call: Callable[[], Any], repetitions: int = 3) -> tuple[Any, float]:
    """Answer of a call, and its median processor time, s."""
    taken = []
    for _ in range(repetitions):
        begun = time.process_time()
        answer = call()
        taken.append(time.process_time() - begun)
    return answer, median(taken)


def missing(topic: str, name: str, peer: str, target: float | None = None) -> Measurement:
    """Row of a comparison whose peer is not installed."""
    return Measurement(topic, name, peer, "", target=target, missing=f"{peer.split()[0]} is not installed")


def unmet(rows: Sequence[Measurement]) -> list[Measurement]:
    """Rows that miss their target."""
    return [row for row in rows if row.met is False]
