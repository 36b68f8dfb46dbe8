"""Jobs and their outcomes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from study.judge import Verdict
from study.planning import RunSettings, Status
from study.problem import Floats
from study.trajectory import Motion


@dataclass(frozen=True)
class Cell:
    """One run: a planner on a case with settings.

    Attributes
    ----------
    case : str
    planner : str
        Registry name.
    label : str
        Name in tables: the registry name, with the options that differ from the paper's own way on this case after a
        colon, such as `golds-pso:scaled,shared`.
    settings : RunSettings
    """

    case: str
    planner: str
    label: str
    settings: RunSettings

    KIND: ClassVar[str] = "cell"


@dataclass(frozen=True, eq=False)
class Result:
    """A finished cell: the planner's answer, the judge's verdict on it and the wall time.

    Attributes
    ----------
    cell : Cell
    status : Status
    message : str
    motion : Motion, optional
    verdict : Verdict, optional
        None only where there is no motion.
    durations : array of shape (n_segments,), s, optional
    evaluations : int
    iterations : int
    history : array of shape (n_records, 2)
        Evaluations so far and best objective so far.
    details : mapping of str to float
    wall_time : float, s
        The planner's own time; imports, judging and storing are not in it.
    lower_bound : float, s, optional
        Proved by a bound, or by a planner for its own kind of motion.
    """

    cell: Cell
    status: Status
    message: str
    motion: Motion | None
    verdict: Verdict | None
    durations: Floats | None
    evaluations: int
    iterations: int
    history: Floats
    details: Mapping[str, float]
    wall_time: float
    lower_bound: float | None = None
