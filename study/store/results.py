"""Jobs and their outcomes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from study.judge import Verdict
from study.planning import Plan, RunSettings


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


@dataclass(frozen=True, eq=False, kw_only=True)
class Result(Plan):
    """A finished cell: the planner's answer, the judge's verdict on it and the wall time.

    Attributes
    ----------
    cell : Cell
    verdict : Verdict, optional
        None only where there is no motion.
    wall_time : float, s
        The planner's own time; imports, judging and storing are not in it.
    """

    cell: Cell
    verdict: Verdict | None = None
    wall_time: float = 0.0

    @property
    def feasible(self) -> bool:
        """True where the judge passed the motion."""
        return self.verdict is not None and self.verdict.feasible

    @property
    def duration(self) -> float:
        """Total time of the motion, feasible or not, s; infinite where there is none."""
        return self.verdict.duration if self.verdict else np.inf

    @property
    def reason(self) -> str:
        """Why there is no feasible motion; empty where there is one."""
        return "; ".join(self.verdict.reasons) if self.verdict else self.message or self.status.value
