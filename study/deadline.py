"""Deadlines of planners on one clock, and a record of whether a deadline cut a planner short.

A result that a deadline cut short is not reproducible: on another machine, or with more time, it may be another.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

from study.supervisor import supervisor


@dataclass(frozen=True)
class Deadline:
    """An instant at which a planner stops by itself.

    Attributes
    ----------
    instant : float, s
        On the monotonic clock; infinite where there is no deadline.
    """

    instant: float

    @classmethod
    def after(cls, seconds: float) -> Deadline:
        """Set a deadline so many seconds from now."""
        return cls(time.monotonic() + seconds)

    def within(self, seconds: float) -> Deadline:
        """Take the earlier of this deadline and one so many seconds from now."""
        return Deadline(min(self.instant, time.monotonic() + seconds))

    def left(self) -> float:
        """Seconds that are left, at least 0."""
        return max(self.instant - time.monotonic(), 0.0)

    def passed(self) -> bool:
        """Whether it is too late; if so, whoever watches the planner learns of it, however deep inside it asked."""
        late = time.monotonic() >= self.instant
        if late:
            record_cut()
        return late


NEVER = Deadline(float("inf"))


def record_cut() -> None:
    """Record that a time limit cut the planner short, as a solver with a clock of its own may say."""
    watching = supervisor()
    if watching is not None:
        watching.deadline_reached = True
