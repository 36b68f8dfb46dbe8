"""Nonlinear programs for IPOPT through CasADi, built and solved by one thread at a time.

CasADi counts the references to its shared nodes without locks, and so does the linear solver inside IPOPT keep one
state: two threads in either of them end the process. Whatever touches a CasADi object therefore runs under one lock,
and objects that a thread drops outside it are freed by the next thread that holds it.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from study.deadline import record_cut
from study.problem import Floats

__all__ = ["Ipopt", "Solution", "alone", "ca", "drop"]

QUIET = {"print_level": 0, "sb": "yes"}
SHORTEST, LONGEST = 1e-3, 1e6
"""Time limits that IPOPT takes, s."""

OUT_OF_TIME = "Maximum_WallTime_Exceeded"
"""Status with which IPOPT stops at its time limit."""

_LOCK = threading.RLock()
_DROPPED: list[Any] = []


@contextmanager
def alone() -> Iterator[None]:
    """Hold the lock around a block, or as a decorator around a function that builds CasADi expressions."""
    with _LOCK:
        _DROPPED.clear()
        yield


def drop(thing: Any, dropped: list[Any] = _DROPPED) -> None:  # bound here: modules lose their names before objects go
    """Leave something that holds CasADi objects to the next thread that has the lock."""
    dropped.append(thing)


@dataclass(frozen=True, eq=False)
class Solution:
    """Answer of one solve.

    Attributes
    ----------
    x : array of shape (n_variables,)
    multipliers : dict of str to array
        Of bounds and rows, as a warm start takes them.
    success : bool
    status : str
        IPOPT's return status.
    iterations : int
    """

    x: Floats
    multipliers: dict[str, Floats]
    success: bool
    status: str
    iterations: int


class Ipopt:
    """One nonlinear program, ready to be solved from many starts.

    Parameters
    ----------
    program : mapping
        CasADi expressions: variables `x`, objective `f`, rows `g`, and parameters `p` where there are any.
    options : mapping
        Of IPOPT.
    time_limit : float, s
        Wall time of every solve.
    """

    _solver: Any = None

    def __init__(self, program: Mapping[str, Any], options: Mapping[str, Any], time_limit: float) -> None:
        ipopt = QUIET | dict(options) | {"max_wall_time": min(max(time_limit, SHORTEST), LONGEST)}
        wanted: dict[str, Any] = {"ipopt": ipopt, "print_time": False, "error_on_fail": False}
        with alone():
            self._solver = ca.nlpsol("program", "ipopt", dict(program), wanted)

    def solve(self, **numbers: Any) -> Solution:
        """Solve from `x0` under the bounds `lbx`, `ubx`, `lbg`, `ubg`; a stop at the time limit is recorded."""
        with alone():
            answer, stats = self._solver(**numbers), self._solver.stats()
            x, *multipliers = (np.array(answer[name], dtype=float).ravel() for name in ("x", "lam_x", "lam_g"))
            del answer
        if stats["return_status"] == OUT_OF_TIME:
            record_cut()
        warm = dict(zip(("lam_x0", "lam_g0"), multipliers, strict=True))
        return Solution(x, warm, bool(stats["success"]), str(stats["return_status"]), int(stats["iter_count"]))

    def __del__(self, drop: Callable[[Any], None] = drop) -> None:
        drop(self._solver)
