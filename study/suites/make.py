"""Suites from their generators: the file as it is committed, and whether a committed file still agrees."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.cases.suite_file import SuiteFile, SuiteLimits, SuiteProblem, checksum_of, filed_suite, text_of
from study.errors import unknown
from study.problem import Floats, JointLimits
from study.suites import hard, robots, scaling
from study.suites.drawn import Drawn

__all__ = ["RECIPES", "differences", "filed", "make", "text_of"]

DIGITS = 7
"""Decimals of a waypoint, rad or m."""

AGREEMENT = 3e-7
"""Difference of a waypoint drawn again that is rounding, rad or m."""


@dataclass(frozen=True)
class Recipe:
    """Generator of a suite, its seed and its description."""

    draw: Callable[[int], list[Drawn]]
    seed: int
    version: int
    about: str


RECIPES = {
    "robots": Recipe(robots.problems, 20, 1, "tasks of real arms, the makers' published limits where there are any"),
    "scaling": Recipe(
        scaling.problems, 20, 1, "random waypoints: 3 to 199 segments, 1 to 14 joints, with and without jerk"
    ),
    "scaling-second": Recipe(
        scaling.problems, 21, 1, "the problems of `scaling` from a second seed, to check a law on"
    ),
    "hard": Recipe(
        hard.problems, 20, 1, "long moves, tiny steps, U-turns, still joints, binding ranges, unlike limits"
    ),
}


def make(name: str, seed: int | None = None) -> SuiteFile:
    """Draw a suite anew; by default with its own seed.

    Raises
    ------
    StudyError
        If no suite of this name has a generator.
    """
    if name not in RECIPES:
        raise unknown("suite with a generator", name, RECIPES)
    recipe = RECIPES[name]
    seed = recipe.seed if seed is None else seed
    problems = [filed(drawn) for drawn in recipe.draw(seed)]
    return SuiteFile(
        suite=name,
        version=recipe.version,
        about=recipe.about,
        seed=seed,
        checksum=checksum_of(problems),
        problems=problems,
    )


def filed(drawn: Drawn) -> SuiteProblem:
    """Put a drawn problem into the form of the file."""
    return SuiteProblem(
        name=drawn.name,
        source=drawn.source,
        tags=list(drawn.tags),
        robot=drawn.robot,
        task=drawn.task,
        units=list(drawn.units),  # type: ignore[arg-type]
        limits=_limits(drawn.limits, drawn.origins),
        end="smooth" if np.isfinite(drawn.limits.jerk).any() else "rest",
        waypoints=np.round(drawn.waypoints, DIGITS).tolist(),
    )


def _limits(limits: JointLimits, origins: dict[str, str]) -> SuiteLimits:
    def rates(values: Floats) -> list[float] | None:
        return [float(f"{value:.12g}") for value in values] if np.isfinite(values).all() else None

    def ends(values: Floats) -> list[float | None] | None:
        finite = [float(f"{value:.12g}") if np.isfinite(value) else None for value in values]
        return None if finite.count(None) == len(finite) else finite

    span = ends(limits.lower), ends(limits.upper)
    given = {
        "velocity": rates(limits.velocity),
        "acceleration": rates(limits.acceleration),
        "jerk": rates(limits.jerk),
    }
    said = [name for name, values in given.items() if values is not None] + ["position"] * (span != (None, None))
    return SuiteLimits.model_validate(
        given | {"lower": span[0], "upper": span[1], "origins": {name: origins[name] for name in said}}
    )


def differences(name: str, drawn: list[Drawn]) -> list[str]:
    """Names of drawn problems that the committed suite has not, or has with other numbers."""
    kept = {problem.name: problem for problem in filed_suite(name).problems}
    return [each.name for each in drawn if each.name not in kept or not _alike(filed(each), kept[each.name])]


def _alike(first: SuiteProblem, second: SuiteProblem) -> bool:
    shapes = len(first.waypoints) == len(second.waypoints)
    rest = {"exclude": {"waypoints"}}
    same = first.model_dump(**rest) == second.model_dump(**rest)  # type: ignore[arg-type]
    return same and shapes and bool(np.allclose(first.waypoints, second.waypoints, rtol=0.0, atol=AGREEMENT))
