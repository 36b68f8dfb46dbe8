"""Problems as the commands take them: a case, or waypoints alone with limits from other files, and wishes about time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from study.cases.bare_file import bare_content
from study.cases.library import PAPERS_OWN, Case, load_case, own_case
from study.errors import StudyError
from study.io.documents import parsed
from study.io.sampling import Sampling
from study.problem import Problem, Timing

LimitFiles = Annotated[
    list[Path] | None,
    typer.Option(
        "--limits", help="For waypoints or a trajectory alone: MoveIt joint_limits.yaml or URDF; may be given twice."
    ),
]
Joints = Annotated[
    str | None, typer.Option(help="For waypoints alone: names of the joints to be planned, separated by commas.")
]
Duration = Annotated[float | None, typer.Option(help="Seconds that the motion takes; it is slowed down to them.")]
Speed = Annotated[float | None, typer.Option(help="Share of the full speed, above 0 and at most 1.")]
Cycle = Annotated[
    float | None, typer.Option(help="Seconds of a control cycle: the motion takes whole cycles, one sample in each.")
]
Points = Annotated[
    int | None, typer.Option(help="Number of points in the files written, for controllers that take few.")
]
Rate = Annotated[
    float | None,
    typer.Option(
        help="Samples per second in the files written, and the end point. [default: 100, or what gives 10 to 100,000 samples, "
        "and every instant at which the motion changes its polynomial]"
    ),
]


@dataclass(frozen=True)
class Wishes:
    """Requested duration and sampling of a motion, from the command line.

    Attributes
    ----------
    duration, cycle : float, s, optional
    speed : float, optional
    rate : float, Hz, optional
    points : int, optional
    """

    duration: float | None = None
    speed: float | None = None
    cycle: float | None = None
    rate: float | None = None
    points: int | None = None

    def __post_init__(self) -> None:
        if self.rate is not None and not 0 < self.rate < float("inf"):
            raise StudyError(f"the rate must be a positive number of samples per second, got {self.rate:g}")
        if self.points is not None and self.points < 2:
            raise StudyError(f"the number of points must be at least 2, got {self.points}")
        if sum(wish is not None for wish in (self.rate, self.points, self.cycle)) > 1:
            raise StudyError("--rate, --points and --cycle each choose the samples; give one of them")
        if self.speed is not None and not 0 < self.speed <= 1:
            raise StudyError(f"--speed must be above 0 and at most 1, got {self.speed:g}")

    @property
    def sampling(self) -> Sampling:
        """Instants at which the motion is written down."""
        return Sampling(self.rate, self.points)

    def on(self, case: Case) -> Case:
        """The case with these wishes; those of its file that are not overruled stay."""
        problem = case.problem if self.speed is None else case.problem.at_speed(self.speed)
        return replace(case, problem=self._timed(problem))

    def _timed(self, problem: Problem) -> Problem:
        if self.duration is None and self.cycle is None:
            return problem
        old = problem.timing or Timing()
        exactly, at_least = (old.exactly, old.at_least) if self.duration is None else (self.duration, None)
        return replace(problem, timing=Timing(exactly, at_least, self.cycle or old.cycle))


def load_any(file: Path, units: str | None = None, limits: Sequence[Path] = (), joints: str | None = None) -> Case:
    """Load a case, or waypoints alone with limits from other files; a name of the study's own cases will do too."""
    content = bare_content(file, units, limits, joints)
    return load_case(file if file.suffix else str(file)) if content is None else own_case(content, file)


def content_of(
    file: Path, wishes: Wishes, units: str | None, limits: Sequence[Path], joints: str | None
) -> dict[str, Any] | None:
    """Content of a case of one's own with everything that options say besides; None where they say nothing of the problem."""
    content, said = bare_content(file, units, limits, joints), (wishes.duration, wishes.speed, wishes.cycle)
    if said == (None, None, None):
        return content
    if content is None:
        given = parsed(file) if file.suffix.lower() in (".yaml", ".yml", ".json") else None
        if not isinstance(given, dict) or PAPERS_OWN & given.keys():
            raise StudyError(f"--duration, --speed and --cycle go with a case of your own; {str(file)!r} is a paper's")
        content = given
    speed = None if wishes.speed is None else wishes.speed * content.get("speed", 1.0)
    own = {"duration": wishes.duration, "speed": speed, "cycle": wishes.cycle}
    return content | {key: value for key, value in own.items() if value is not None}
