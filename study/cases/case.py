"""A case: a problem, its paper's planner settings and its printed results."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from study.errors import StudyError
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


@dataclass(frozen=True, eq=False, kw_only=True)
class Case:
    """One problem of the study and how its paper solves it.

    Attributes
    ----------
    name : str
    title : str
        One line for people.
    paper : str
        Key of the paper, such as `woodworking-golds-pso`; `own` for a case of one's own.
    problem : Problem
    curve : str
        The paper's curve family, a name in `study.curves.CURVES`.
    settings : RunSettings
        The paper's population, budget, formulation and synchronisation.
    planner : str
        Registry name of the paper's own planner; GoldS-PSO where there is no paper.
    robot : str, optional
        Name of a robot in `study.robots`.
    units : tuple of str
        `rad` or `m` for each joint.
    published : tuple of Published
    notes : tuple of str
        What a reader must know: readings taken, values of ours.
    default : bool
        Whether `study run` takes the case without being asked.
    fixed_joints : mapping of int to float, rad or m
        Robot joints, counted from 0, that the problem leaves out and where they stand.
    position_range : array of shape (2, n_joints), rad or m, optional
        Range of positions that the paper prints; it is judged only where the problem's limits repeat it.
    sources : mapping of str to str
        Field of the case: the place in the paper it was read from, or `ours: ` and why.
    obstacles : array of shape (n_obstacles, 2, 3), m
        Lower and upper corners of boxes in the robot's base frame.
    arm_radius : float, m
        Of the capsules that stand for the links where obstacles are looked for.
    self_collision : bool
        Whether the arm is looked at for touching itself.
    limits_label : str
        Which limits the problem has, in a word or two, such as `published` or `jerk-matched`.
    variant_of : str
        Name of the case that this one varies; empty for a case of its own.
    warnings : tuple of str
        One sentence for everything in a file of one's own that is not used, or could be taken otherwise.
    typed : tuple of str
        Units that a file of one's own states, such as `deg` and `mm`; empty where they are `units`.
    """

    name: str
    title: str
    paper: str = "own"
    problem: Problem
    curve: str
    settings: RunSettings
    planner: str = "golds-pso"
    robot: str | None = None
    units: tuple[str, ...]
    published: tuple[Published, ...] = ()
    notes: tuple[str, ...] = ()
    default: bool = True
    fixed_joints: Mapping[int, float] = field(default_factory=dict)
    position_range: Floats | None = None
    sources: Mapping[str, str] = field(default_factory=dict)
    obstacles: Floats = field(default_factory=lambda: np.empty((0, 2, 3)))
    arm_radius: float = 0.05
    self_collision: bool = False
    limits_label: str = "given"
    variant_of: str = ""
    warnings: tuple[str, ...] = ()
    typed: tuple[str, ...] = ()

    @property
    def velocity_only(self) -> bool:
        """Whether a joint has no acceleration limit, so that a motion off the curve may change its speed in an instant."""
        return bool(np.isinf(self.problem.limits.acceleration).any())

    def robot_configuration(self, q: ArrayLike) -> Floats:
        """Put the joints that the problem leaves out back in their places.

        Parameters
        ----------
        q : array of shape (n, n_joints), rad or m
            Configurations of the problem.

        Returns
        -------
        array of shape (n, n_robot_joints), rad or m

        Raises
        ------
        StudyError
            If the configurations have another number of joints than the problem.
        """
        moving = np.atleast_2d(np.asarray(q, dtype=float))
        if moving.ndim != 2 or moving.shape[1] != self.problem.n_joints:
            raise StudyError(
                f"case {self.name!r}: configurations must have shape (n, {self.problem.n_joints}), got {np.shape(q)}"
            )
        whole = np.empty((len(moving), moving.shape[1] + len(self.fixed_joints)))
        fixed = sorted(self.fixed_joints)
        whole[:, fixed] = [self.fixed_joints[joint] for joint in fixed]
        whole[:, np.setdiff1d(np.arange(whole.shape[1]), fixed)] = moving
        return whole
