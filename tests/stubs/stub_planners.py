"""Planners that behave and planners that misbehave, installed for the tests as a stranger's package would be."""

import os
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from study.bounds import LowerBound
from study.curves import curve_named
from study.errors import StudyError
from study.formulation import Scaled
from study.planning import RATE_LIMITS, Freedom, Plan, Status
from study.problem import Demand

NUMBER = 7


def scaled_plan(problem, settings, durations):
    curve = curve_named(settings.curve)
    durations = Scaled(problem, curve).durations(durations[None])[0]
    motion = curve.motion(problem.waypoints, durations)
    return Plan(Status.FINISHED, motion, durations, evaluations=1, history=np.array([[1.0, durations.sum()]]))


class Steady:
    """Equal durations, stretched until they are feasible."""

    stochastic: ClassVar[bool] = False
    about: ClassVar[str] = "equal durations"
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS

    def plan(self, problem, settings):
        return scaled_plan(problem, settings, np.ones(problem.n_segments))


def make_steady():
    return Steady()


@dataclass(frozen=True)
class Seeded:
    """Random durations, after doing something first."""

    before: Callable[[], None]
    stochastic: ClassVar[bool] = True
    about: ClassVar[str] = "random durations"
    freedom: ClassVar[Freedom] = Freedom.CURVE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS

    def plan(self, problem, settings):
        self.before()
        rng = np.random.default_rng(settings.seed)
        return scaled_plan(problem, settings, rng.uniform(0.5, 2.0, problem.n_segments))


def refuse():
    raise StudyError("this problem is not for me")


class Odd(Steady):
    def plan(self, problem, settings):
        return Plan(Status.FINISHED, motion="not a motion")


class Unsendable(Steady):
    def plan(self, problem, settings):
        return Plan(Status.FAILED, details={"lambda": lambda: None})


SEEDED = Seeded(lambda: None)
SLOW = Seeded(lambda: time.sleep(0.15))
CRASH = Seeded(lambda: os.kill(os.getpid(), signal.SIGSEGV))
EXIT = Seeded(lambda: os._exit(5))
HANG = Seeded(lambda: time.sleep(3600))
RAISE = Seeded(lambda: {}[object()])
REFUSE = Seeded(refuse)
ODD = Odd()
UNSENDABLE = Unsendable()
SOCKET = Seeded(lambda: socket.create_connection(("192.0.2.1", 9), timeout=1))
GREEDY = Seeded(lambda: bytearray(2 * 10**9))


class Half:
    """A bound that proves half a second."""

    about = "half a second, whatever the problem"
    freedom = Freedom.FREE
    knows = RATE_LIMITS

    def bound(self, problem, settings):
        return LowerBound(0.5, self.freedom, "half a second at least", {"halves": 1.0})


NOBODY = object()
