"""A free path driven anew: TOPP-RA finds the fastest speed along it under limits of the arm, where no jerk is limited.

The path is a natural cubic spline through points of the motion, its parameter the length of the way in units of the
velocity limits; the waypoints are among the points, so it passes them exactly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.interpolate import CubicSpline

from baselines.path_timing.path import Path, chord_lengths
from study.demands import PLAIN
from study.errors import StudyError
from study.judge import judge
from study.problem import Floats, JointLimits, Problem
from study.trajectory import Motion, Trajectory

POINTS, FINE, GRID = 8, 200, 30
"""Points of the path on every segment, instants that they are chosen from, and steps of the grid between two points."""


def along_itself(problem: Problem, motion: Motion) -> Trajectory | None:
    """Drive the path of a motion within limits of the arm; None where that is not possible, or TOPP-RA not installed.

    Parameters
    ----------
    problem : Problem
    motion : Motion
        Through the waypoints; how fast it is does not matter.
    """
    try:
        from baselines.path_timing.toppra import Toppra, retime  # here: few problems need the package
    except ModuleNotFoundError:
        return None
    jerky = bool(np.isfinite(problem.limits.jerk).any())
    if jerky or not problem.scalable or not problem.planner_demands <= Toppra.knows | PLAIN:
        return None
    try:
        dense = replace(problem, waypoints=_points(problem, motion))
        retimed = retime(dense, GRID, natural_by_length)
    except StudyError:
        return None
    if retimed is None:
        return None
    passing = replace(retimed.motion, waypoint_times=retimed.motion.waypoint_times[::POINTS])
    return passing if judge(problem, passing).feasible else None


def natural_by_length(points: Floats, limits: JointLimits) -> Path:
    """Lay the natural cubic spline, its parameter by the chords, through distinct neighbouring points.

    Parameters
    ----------
    points : array of shape (n_points, n_joints), rad or m
    limits : JointLimits
        Joints are measured by them.
    """
    knots = np.concatenate([[0.0], np.cumsum(chord_lengths(points, limits))])
    spline = CubicSpline(knots, points, bc_type="natural")
    return Path(knots, np.moveaxis(spline.c[::-1], 0, 1), clamped=False)


def _points(problem: Problem, motion: Motion) -> Floats:
    """Waypoints, and points of the motion between them at equal lengths of the way, `POINTS` steps on every segment."""
    times, rows = motion.waypoint_times, []
    for segment in range(problem.n_segments):
        instants = np.linspace(times[segment], times[segment + 1], FINE)
        way = np.concatenate([[0.0], np.cumsum(chord_lengths(motion(instants), problem.limits))])
        inner = motion(np.interp(np.linspace(0.0, way[-1], POINTS + 1)[1:-1], way, instants))
        rows += [problem.waypoints[segment : segment + 1], inner]
    return np.concatenate([*rows, problem.waypoints[-1:]])
