"""A robot description with nothing but joints and their limits, for packages that ask for one."""

from __future__ import annotations

import numpy as np

from study.problem import Problem

FARTHEST = 1e3
"""Range of positions where a joint has none."""


def names_of(problem: Problem) -> list[str]:
    """Names of the joints, which every package takes."""
    return [f"j{joint}" for joint in range(problem.n_joints)]


def urdf(problem: Problem) -> str:
    """A chain of prismatic joints, in which positions are plain numbers, in the format URDF."""
    lower, upper = np.maximum(problem.limits.lower, -FARTHEST), np.minimum(problem.limits.upper, FARTHEST)
    rows = ['<robot name="arm" xmlns:tesseract="tesseract" tesseract:make_convex="true">', '<link name="l0"/>']
    for joint, name in enumerate(names_of(problem)):
        rows += [
            f'<link name="l{joint + 1}"/><joint name="{name}" type="prismatic">',
            f'<parent link="l{joint}"/><child link="l{joint + 1}"/><axis xyz="0 0 1"/>',
            f'<limit lower="{lower[joint]}" upper="{upper[joint]}" velocity="{problem.limits.velocity[joint]}"',
            'effort="1"/></joint>',
        ]
    return "\n".join([*rows, "</robot>"])
