"""Problems of a suite as committed data: waypoints as numbers, limits with their origins, a version and a checksum."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from study.cases.case import Case
from study.datafiles import Strict, checked, data_folder
from study.errors import StudyError, unknown
from study.io.documents import parsed
from study.planning import usual_settings
from study.problem import EndCondition, JointLimits, Problem

EVALUATIONS = 15000
"""Budget of the searches where none is asked for, as on a case of one's own."""

Row = list[float]
PositiveRow = list[Annotated[float, Field(gt=0)]]


class SuiteLimits(Strict):
    """Limits of every joint in rad or m and s, and who says so; what is left out does not limit, nor does null in a range."""

    velocity: PositiveRow
    acceleration: PositiveRow | None = None
    jerk: PositiveRow | None = None
    lower: list[float | None] | None = None
    upper: list[float | None] | None = None
    origins: dict[Literal["velocity", "acceleration", "jerk", "position"], str]


class SuiteProblem(Strict):
    """One problem: where it comes from, what it is like, and its numbers in rad or m and s."""

    name: str = Field(pattern=r"^[a-z0-9][a-z0-9.-]*$")
    source: str
    tags: list[str]
    robot: str | None = None
    task: str
    units: list[Literal["rad", "m"]]
    limits: SuiteLimits
    end: Literal["rest", "smooth"]
    waypoints: list[Row]

    def case(self, suite: str) -> Case:
        """Build the case, named `SUITE:NAME`."""
        limits = self.limits
        problem = Problem(
            f"{suite}:{self.name}",
            np.array(self.waypoints),
            JointLimits(
                np.array(limits.velocity),
                np.array(np.inf if limits.acceleration is None else limits.acceleration),
                np.array(np.inf if limits.jerk is None else limits.jerk),
                _open(limits.lower, -np.inf),
                _open(limits.upper, np.inf),
            ),
            end=EndCondition[self.end.upper()],
        )
        settings = usual_settings(problem)
        return Case(
            name=problem.name,
            title=f"{self.task}; {self.source}",
            paper="own",
            problem=problem,
            curve=settings.curve,
            settings=replace(settings, evaluations=EVALUATIONS),
            planner="golds-pso",
            robot=self.robot,
            units=tuple(self.units),
            published=(),
            notes=(f"tags: {', '.join(self.tags)}",),
            default=False,
            sources={"waypoints": self.source} | {f"{name} limits": text for name, text in limits.origins.items()},
        )


class SuiteFile(Strict):
    """A suite: `data/suites/NAME.json`."""

    suite: str
    version: Annotated[int, Field(ge=1)]
    about: str
    seed: int
    checksum: str
    problems: list[SuiteProblem]


def _open(values: list[float | None] | None, infinite: float) -> Any:
    return None if values is None else np.array([infinite if value is None else value for value in values])


def checksum_of(problems: list[SuiteProblem]) -> str:
    """Checksum of problems by their content, 16 hexadecimal digits."""
    content = json.dumps([problem.model_dump() for problem in problems], sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(content.encode()).hexdigest()[:16]


def suites_folder() -> Path:
    """Folder of the suites' data."""
    return data_folder() / "suites"


def filed_suites() -> list[str]:
    """Names of the suites that have a file."""
    return sorted(path.stem for path in suites_folder().glob("*.json"))


@cache
def filed_suite(name: str) -> SuiteFile:
    """Read a suite, and every problem in a file of its own in the folder of the suite's name.

    Raises
    ------
    StudyError
        If there is no such suite, a file is broken, or the checksum is not that of the problems.
    """
    if name not in filed_suites():
        raise unknown("suite", name, filed_suites())
    path = suites_folder() / f"{name}.json"
    suite = checked(SuiteFile, parsed(path), f"file {path.name!r}")
    if checksum_of(suite.problems) != suite.checksum:
        raise StudyError(
            f"file {path.name!r} is not what its checksum says; put a problem of your own into a file of its own in "
            f"{path.stem}/, or write the suite again with `study suite make {name}`"
        )
    problems = [*suite.problems, *_added(path.with_suffix(""))]
    names = [problem.name for problem in problems]
    if doubled := {each for each in names if names.count(each) > 1}:
        raise StudyError(f"suite {name!r}: problem {min(doubled)!r} is there twice; rename one")
    return suite.model_copy(update={"problems": problems, "checksum": checksum_of(problems)})


def _added(folder: Path) -> Iterator[SuiteProblem]:
    for path in sorted(folder.glob("*.yaml")):
        yield checked(SuiteProblem, parsed(path), f"file {path.name!r}")


def suite_case(text: str) -> Case:
    """Case of a problem named `SUITE:NAME`.

    Raises
    ------
    StudyError
        If there is no such suite or problem.
    """
    suite, _, name = text.partition(":")
    problems = {problem.name: problem for problem in filed_suite(suite).problems}
    if name not in problems:
        raise unknown(f"problem of suite {suite!r}:", name, problems)
    return problems[name].case(suite)


def text_of(suite: SuiteFile) -> str:
    """Write a suite as it is committed: JSON, one line for each waypoint."""
    head = suite.model_dump(exclude={"problems"})
    lines = [f"{json.dumps(key)}: {json.dumps(value)}," for key, value in head.items()]
    problems = []
    for problem in suite.problems:
        content = problem.model_dump(exclude={"waypoints"})
        rows = ",\n  ".join(json.dumps(row, separators=(",", ":")) for row in problem.waypoints)
        problems.append(f' {json.dumps(content)[:-1]}, "waypoints": [\n  {rows}]}}')
    return "{\n" + "\n".join(lines) + '\n"problems": [\n' + ",\n".join(problems) + "\n]}\n"
