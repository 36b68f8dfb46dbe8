"""Remember that a planner looked at the clock and stopped: what it then answers may be another answer on another machine."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass


@dataclass
class Watch:
    """Whether a deadline was reached.

    Attributes
    ----------
    reached : bool
    """

    reached: bool = False


_watch: ContextVar[Watch | None] = ContextVar("watch", default=None)


def noted(late: bool) -> bool:
    """Return whether it is too late, and note it if so.

    Every planner asks its clock through this, however deep inside, so that whoever runs the planner learns of it.
    """
    watch = _watch.get()
    if late and watch is not None:
        watch.reached = True
    return late


@contextmanager
def watched() -> Iterator[Watch]:
    """Learn whether any deadline is reached in this block."""
    watch = Watch()
    token = _watch.set(watch)
    try:
        yield watch
    finally:
        _watch.reset(token)
