"""The papers' cases: what stands in `data/cases`, checked at the door."""

from __future__ import annotations

from dataclasses import dataclass

from study.planning import RunSettings
from study.problem import Floats, Problem


@dataclass(frozen=True, eq=False)
class Published:
    """A result that a paper prints, as segment durations where it gives them.

    Attributes
    ----------
    label : str
        The paper's name for it, such as `GoldS-PSO`.
    total : float, optional, s
        Total time as printed.
    durations : array of shape (n_segments,), s, optional
    joint : int, optional
        Counted from 0, where the durations belong to one joint alone.
    source : str
        Table or section.
    """

    label: str
    total: float | None
    durations: Floats | None
    joint: int | None
    source: str


@dataclass(frozen=True, eq=False)
class Case:
    """One problem of the study and how its paper solves it.

    Attributes
    ----------
    name : str
    title : str
        One line for people.
    paper : str
        Key of the paper, such as `woodworking-golds-pso`.
    problem : Problem
    curve : str
        The paper's curve family, a name in `study.curves.CURVES`.
    settings : RunSettings
        The paper's population, budget, formulation and synchronisation.
    planner : str
        Registry name of the paper's own planner.
    robot : str, optional
        Name of a robot in `study.robots`.
    units : tuple of str
        `rad` or `m` for each joint.
    published : tuple of Published
    notes : tuple of str
        What a reader must know: readings taken, values of ours.
    default : bool
        Whether `study run` takes the case without being asked.
    """

    name: str
    title: str
    paper: str
    problem: Problem
    curve: str
    settings: RunSettings
    planner: str
    robot: str | None
    units: tuple[str, ...]
    published: tuple[Published, ...]
    notes: tuple[str, ...]
    default: bool = True
