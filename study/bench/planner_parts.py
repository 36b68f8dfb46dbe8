"""The planner's own measurements: dense paths, replanning on the way, pieces, the IPOPT program, Ruckig's long moves."""

from __future__ import annotations

import contextlib
import importlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from statistics import median
from typing import Any

import numpy as np

from study.api import onward, plan
from study.bench.measuring import timed
from study.judge import judge
from study.planning import Plan, Planner, usual_settings
from study.problem import EndCondition, Floats, JointLimits, Problem
from study.registry import planner_named
from study.suites.tasks import arm_problems

Told = Callable[[str], None]
Cells = tuple[str, ...]
THINNED, DENSE = 50, (50, 200, 1000, 3000)
CHAINS, BEYOND = 9, 1e-6


@dataclass(frozen=True)
class Part:
    """One part's answer.

    Attributes
    ----------
    title : str
    head : tuple of str
    rows : tuple of tuples of str
    sentences : tuple of str
    """

    title: str
    head: Cells
    rows: tuple[Cells, ...]
    sentences: Cells = ()


def walk(n_waypoints: int, seed: int, jerk: bool = True) -> Problem:
    """Seven joints on a random walk, steps within half a radian; 1.5 rad/s, 5 rad/s^2 and 50 rad/s^3."""
    waypoints = np.cumsum(np.random.default_rng(seed).uniform(-0.5, 0.5, (n_waypoints, 7)), axis=0)
    limits = JointLimits(np.full(7, 1.5), np.full(7, 5.0), np.full(7, 50.0 if jerk else np.inf))
    return Problem(f"walk of {n_waypoints}", waypoints, limits, end=EndCondition.REST)


def smooth(n_waypoints: int, seed: int) -> Problem:
    """The same joints on one smooth path, given by any number of points."""
    rng = np.random.default_rng(seed)
    u, size = np.linspace(0, 1, n_waypoints)[:, None, None], rng.uniform(0.1, 0.5, (7, 3))
    waves = size * np.sin(np.pi * u * np.arange(1, 4) + rng.uniform(0, 2 * np.pi, (7, 3)))
    return replace(walk(2, seed), name=f"smooth path, {n_waypoints} points", waypoints=waves.sum(axis=2))


def solved(name: str, problem: Problem, pieces: int | None = None) -> tuple[float, float]:
    """Duration by the judge and processor time of a planner, with another number of pieces where given; s."""
    planner: Planner = planner_named(name)
    if pieces is not None:
        planner = replace(planner, pieces=pieces)  # type: ignore[type-var]
    answer, seconds = timed(lambda: planner.plan(problem, usual_settings(problem)), 1 if "nlp" in name else 3)
    return _judged(problem, answer), seconds


def _judged(problem: Problem, answer: Plan) -> float:
    if answer.motion is None:
        return np.inf
    verdict = judge(problem, answer.motion)
    return verdict.duration if verdict.feasible else np.inf


def dense(seed: int, told: Told) -> Part:
    """One smooth path with more and more points: durations beside 50 points, and how the time grows."""
    rows, seconds = [], []
    reference = 1.0
    for count in DENSE:
        problem = smooth(count, seed)
        told(problem.name)
        duration, taken = solved("free-path", problem)
        reference = duration if count == THINNED else reference
        seconds.append(taken)
        rows.append((str(count), f"{duration:.4f}", f"{100 * (duration / reference - 1):+.2f} %", f"{taken:.2f}"))
    growth = np.log(seconds[-1] / seconds[0]) / np.log(DENSE[-1] / DENSE[0])
    head = "points", "duration s", f"above {THINNED} points", "processor s"
    return Part(f"A smooth path, seed {seed}", head, tuple(rows), (f"exponent of growth: {growth:.2f} (at most 1.2)",))


def online(seed: int, told: Told) -> Part:
    """From every tenth of a motion on to its next five waypoints, in a loop: time of a call."""
    rows = []
    for problem in arm_problems(seed):
        if "rand" not in problem.name:
            continue
        told(problem.name)
        motion = plan(problem, "fast").motion
        for tier in ("fast", "best"):
            costs, good = zip(*_on_the_way(problem, motion, tier), strict=True)
            text = f"{sum(good)} of {len(good)}"
            rows.append((problem.name, tier, f"{median(costs) * 1e3:.0f}", f"{max(costs) * 1e3:.0f}", text))
    head = "problem", "tier", "median ms", "most ms", "feasible"
    return Part(f"From a moving arm to five new waypoints, seed {seed}", head, tuple(rows))


def _on_the_way(problem: Problem, motion: Any, tier: str) -> Iterator[tuple[float, bool]]:
    for at in np.arange(0.05, 0.95, 0.1) * motion.duration:
        following = int(np.searchsorted(motion.waypoint_times, at + 1e-6))
        asked = onward(problem, motion, float(at), problem.waypoints[following : following + 5])
        answer, seconds = timed(lambda asked=asked: plan(asked, tier), 1)  # type: ignore[misc]
        yield seconds, answer.feasible


def pieces(seed: int, told: Told) -> Part:
    """K equal pieces of every segment beside widths of every joint's own."""
    rows = []
    for jerk in (True, False):
        for count in (5, 10, 20):
            problem = walk(count, seed, jerk)
            told(problem.name)
            free, _ = solved("free-path", problem)
            gaps = [solved("free-path-nlp", problem, k)[0] / free - 1 for k in (4, 8, 16)]
            cells = "with" if jerk else "without", str(count), f"{free:.5f}", *(f"{100 * gap:.2f} %" for gap in gaps)
            rows.append(cells)
    head = "jerk limit", "waypoints", "free widths s", "K = 4", "K = 8", "K = 16"
    return Part(f"How far K equal pieces are above free widths, seed {seed}", head, tuple(rows))


def nlp(seed: int, told: Told) -> Part:
    """48 random walks next to the IPOPT program; best known is the best of both, and of twelve pieces."""
    rows, above, behind = [], [], []
    for count, problems in ((10, 24), (20, 16), (50, 8)):
        for jerk in (True, False):
            shares = []
            for number in range(problems // 2):
                problem = walk(count, 1000 * (seed + 1) + number, jerk)
                told(f"{problem.name}, number {number}")
                (ours, cost), (theirs, other) = solved("free-path", problem), solved("free-path-nlp", problem)
                known = min(ours, theirs, solved("free-path", problem, 12)[0])
                above.append(ours / theirs - 1)
                behind.append(ours / known - 1)
                shares.append(other / cost)
            cells = str(count), "with" if jerk else "without", str(len(shares)), f"1/{median(shares):.1f}"
            rows.append((*cells, f"{max(above[-len(shares) :]):+.1e}", f"{100 * max(behind[-len(shares) :]):.4f} %"))
    sentences = (
        f"most above free-path-nlp: {max(above):+.1e} (at most 1e-4)",
        f"most above the best known: {100 * max(behind):.4f} % (at most 0.02 %)",
    )
    head = "waypoints", "jerk limit", "problems", "time of free-path", "worst against free-path-nlp", "above best known"
    return Part(f"free-path beside free-path-nlp, seed {seed}", head, tuple(rows), sentences)


def long_moves(seed: int, told: Told) -> Part:
    """Ruckig between the states of `free-path` in its segment durations: how often joints break the velocity limit."""
    rows, above = [], []
    for number in range(CHAINS):
        problem = walk(20, 100 * seed + number)
        told(f"{problem.name}, number {number}")
        peaks = _chained_peaks(problem)
        above.append(peaks[np.isfinite(peaks)] - 1)
        beyond = int((above[-1] > BEYOND).sum())
        rows.append((str(number), str(len(above[-1])), str(beyond), f"{100 * above[-1].max():.3f} %"))
    version, every = importlib.import_module("ruckig").__version__, np.concatenate(above)
    sentence = (
        f"{int((every > BEYOND).sum())} of {len(every)} profiles exceed the velocity limit, in "
        f"{sum(bool((part > BEYOND).any()) for part in above)} of {CHAINS} motions, by at most {100 * every.max():.3f} %"
    )
    head = "motion", "profiles", "above the limit", "highest above"
    return Part(f"Velocity of Ruckig {version} with given durations, seed {seed}", head, tuple(rows), (sentence,))


def _chained_peaks(problem: Problem) -> Floats:
    """Largest velocity of every joint in every segment, by its limit; not a number where Ruckig finds no move."""
    ruckig: Any = importlib.import_module("ruckig")
    motion = plan(problem, "free-path").motion
    marks = motion.waypoint_times
    states = [motion(marks, order) for order in range(3)]
    given, solver = ruckig.InputParameter(1), ruckig.Ruckig(1)
    given.max_velocity, given.max_acceleration, given.max_jerk = ([float(rate[0])] for rate in problem.limits.rates)
    peaks = np.full((problem.n_segments, problem.n_joints), np.nan)
    for k, j in np.ndindex(*peaks.shape):
        (given.current_position, given.target_position), (given.current_velocity, given.target_velocity) = (
            ([float(rate[k, j])], [float(rate[k + 1, j])]) for rate in states[:2]
        )
        given.current_acceleration, given.target_acceleration = [float(states[2][k, j])], [float(states[2][k + 1, j])]
        given.minimum_duration = float(marks[k + 1] - marks[k])
        move = ruckig.Trajectory(1)
        with contextlib.suppress(ruckig.RuckigError, ValueError):
            if solver.calculate(given, move) >= 0:
                speeds = [abs(move.at_time(float(t))[1][0]) for t in np.linspace(0, move.duration, 200)]
                peaks[k, j] = max(speeds) / problem.limits.velocity[j]
    return peaks.ravel()
