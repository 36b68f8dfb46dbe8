"""The one who runs a planner, and all that is said to them from within: a deadline reached, populations, progress."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import Any


@dataclass
class Supervisor:
    """Whoever runs the planner that is running now.

    Attributes
    ----------
    deadline_reached : bool
        Whether a deadline cut the planner short.
    on_population : callable (meter, candidates), optional
        Told of every population of a search after it has been counted.
    tell : callable (anything), optional
        In a worker that is listened to, sends something to the main process in the middle of a job.
    """

    deadline_reached: bool = False
    on_population: Callable[[Any, Any], None] | None = None
    tell: Callable[[Any], None] | None = None


_supervisor: ContextVar[Supervisor | None] = ContextVar("supervisor", default=None)


def supervisor() -> Supervisor | None:
    """Whoever runs this planner; None where nobody watches."""
    return _supervisor.get()


@contextmanager
def supervised(
    on_population: Callable[[Any, Any], None] | None = None, tell: Callable[[Any], None] | None = None
) -> Iterator[Supervisor]:
    """Watch the planners that run in this block."""
    own = Supervisor(False, on_population, tell)
    token = _supervisor.set(own)
    try:
        yield own
    finally:
        _supervisor.reset(token)
