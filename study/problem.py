"""The question put to every planner: waypoints, limits, and everything else that a motion through them must do."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from study.arm import ArmLimits
from study.arrays import Floats, check_kinds, frozen_array, index_in, of_kind, positive
from study.demands import ARM, Demand
from study.errors import StudyError, joint_error
from study.limits import LARGEST, OPTIONAL, JointLimits, usual_bounds
from study.rules import EndCondition, PathRule, State, StraightPath, Timing, Tube, alone, radii
from study.tolerances import TOLERANCE, floors

__all__ = [
    "Demand",
    "EndCondition",
    "Floats",
    "JointLimits",
    "Problem",
    "State",
    "StraightPath",
    "Timing",
    "Tube",
    "frozen_array",
    "usual_bounds",
]


@dataclass(frozen=True, eq=False)
class Problem:
    """Pass through waypoints in order, as fast as the demands allow.

    Parameters
    ----------
    name : str
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
    end : EndCondition
        Condition at both ends, where `start` and `finish` say nothing else; by default `SMOOTH` where jerk is limited, since
        the acceleration may not step there, and `REST` elsewhere.
    duration_bounds : tuple of two floats, s, optional
        The box (lower, upper) in which segment-time searches look; the lower bound also holds for
        deterministic segment-time methods. The judge does not use it. Without it, `usual_bounds` of the waypoints and
        limits is taken.
    allow_dwell : bool
        Whether neighbouring waypoints may be equal, as they may when one joint is taken alone.
    joint_names : tuple of str, optional
    start, finish : State or EndCondition, optional
        Rates at the first and at the last instant.
    stops : sequence of int, optional
        Inner waypoints, counted from 0, at which the velocity is zero.
    dwells : mapping of int to float, s, optional
        Inner waypoints at which the arm stands still for at least so long from its arrival on.
    segment_limits : mapping of int to JointLimits, optional
        Limits that hold on single segments, counted from 0, besides `limits`.
    tolerance : float, array of shape (n_waypoints,) or (n_waypoints, n_joints), rad or m, optional
        Distance at which a waypoint may be passed. Always allowed are one part in a million of the joint's span and a
        nanometre or nanoradian; see `study.tolerances`.
    path : StraightPath or Tube, optional
        Where the path between waypoints must run; by default it is free.
    timing : Timing, optional
    arm : ArmLimits, optional
        Limits of torque and of the tool, with the arm that they are about.

    Raises
    ------
    StudyError
        If a part has another type or shape than stated, neighbouring waypoints are equal, or demands contradict each other.
    """

    name: str
    waypoints: Floats
    limits: JointLimits
    end: EndCondition = OPTIONAL
    duration_bounds: tuple[float, float] = OPTIONAL
    allow_dwell: bool = False
    joint_names: Sequence[str] = ()
    start: State | EndCondition | None = None
    finish: State | EndCondition | None = None
    stops: Sequence[int] = ()
    dwells: Mapping[int, float] = OPTIONAL
    segment_limits: Mapping[int, JointLimits] = OPTIONAL
    tolerance: Floats | None = None
    path: PathRule | None = None
    timing: Timing | None = None
    arm: ArmLimits | None = None

    def __post_init__(self) -> None:
        if self.end is None and isinstance(self.limits, JointLimits):
            smooth = bool(np.isfinite(self.limits.rates[2]).any())
            self._set("end", EndCondition.SMOOTH if smooth else EndCondition.REST)
        of_kind(self.name, str, "the name of a problem")
        check_kinds(self, _KINDS, self._where)
        self._take_waypoints()
        self._check_positions()
        self._take_names_and_bounds()
        self._take_ends()
        self._take_passages()
        if self.path is not None:
            self.path.of(self.n_joints)
        if self.arm is not None:
            self.arm.check(self.waypoints, self._where)

    @property
    def _where(self) -> str:
        return f"case {self.name!r}"

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _take_waypoints(self) -> None:
        points, n_joints = frozen_array(self.waypoints, f"{self._where}: waypoints"), self.limits.n_joints
        self._set("waypoints", points)
        if points.ndim != 2 or points.shape[1] != n_joints or len(points) < 2:
            raise StudyError(
                f"{self._where}: waypoints must have shape (n_waypoints >= 2, {n_joints}) to match the limits, "
                f"got {points.shape}"
            )
        if (beyond := ~(np.abs(points) <= LARGEST).all(axis=1)).any():
            row = int(np.argmax(beyond))
            raise StudyError(
                f"{self._where}: waypoint {row + 1} is infinite or too large; give numbers up to {LARGEST:g}"
            )
        if not np.isfinite(self.limits.rates).any() and not self.allow_dwell:
            raise StudyError(
                f"{self._where}: no joint has a finite limit, so there is no shortest time; give a velocity limit"
            )
        if (repeated := (points[1:] == points[:-1]).all(axis=1)).any() and not self.allow_dwell:
            row = int(np.argmax(repeated)) + 1
            raise StudyError(
                f"{self._where}: waypoints {row} and {row + 1} are equal, so the segment between them has no length; "
                "remove one"
            )

    def _check_positions(self) -> None:
        if (outside := (self.waypoints < self.limits.lower) | (self.waypoints > self.limits.upper)).any():
            row, joint = np.argwhere(outside)[0]
            values = self.waypoints[row, joint], self.limits.lower[joint], self.limits.upper[joint]
            said = f"waypoint {row + 1} puts {{joint}} at {{0}}, outside its range [{{1}}, {{2}}]"
            raise joint_error(said, int(joint), *values, where=self._where)

    def _take_names_and_bounds(self) -> None:
        if self.duration_bounds is None:
            self._set("duration_bounds", usual_bounds(self.waypoints, self.limits))
        bounds = frozen_array(self.duration_bounds, f"{self._where}: duration bounds")
        if bounds.shape != (2,) or not 0 <= bounds[0] < bounds[1] < np.inf:
            got = ", ".join(f"{bound:g}" for bound in bounds.ravel())
            raise StudyError(f"{self._where}: duration bounds must satisfy 0 <= lower < upper, got ({got}) s")
        self._set("duration_bounds", tuple(bounds.tolist()))
        names = tuple(self.joint_names) or tuple(f"joint {j + 1}" for j in range(self.n_joints))
        if len(names) != self.n_joints or isinstance(self.joint_names, str):
            raise StudyError(
                f"{self._where}: {len(names)} joint names for {self.n_joints} joints; give a list with one for each"
            )
        self._set("joint_names", tuple(of_kind(name, str, f"{self._where}: a joint's name") for name in names))

    def _take_ends(self) -> None:
        for state in self.end_states:
            state.check(self.limits, self._where)
        plain = {state.condition for state in self.end_states}
        if len(plain) == 1 and None not in plain:
            self._set("end", plain.pop())
            self._set("start", None)
            self._set("finish", None)

    def _take_passages(self) -> None:
        where, inner, segments = self._where, range(1, self.n_waypoints - 1), range(self.n_segments)
        self._set("stops", tuple(sorted({index_in(k, inner, f"{where}: stop") for k in self.stops})))
        dwells = {index_in(k, inner, f"{where}: dwell"): time for k, time in (self.dwells or {}).items()}
        self._set("dwells", {k: positive(time, f"{where}: dwell at waypoint {k}") for k, time in dwells.items()})
        given = {index_in(k, segments, f"{where}: segment limit"): v for k, v in (self.segment_limits or {}).items()}
        self._set("segment_limits", {k: self._limits_of_segment(k, limits) for k, limits in given.items()})
        if self.tolerance is not None:
            self._set("tolerance", radii(self.tolerance, self.n_waypoints, self.n_joints, self._where))

    def _limits_of_segment(self, segment: int, limits: JointLimits) -> JointLimits:
        if not isinstance(limits, JointLimits) or limits.n_joints != self.n_joints:
            raise StudyError(
                f"{self._where}: limits of segment {segment} must be JointLimits of {self.n_joints} joints"
            )
        ends = self.waypoints[segment : segment + 2]
        if ((ends < limits.lower) | (ends > limits.upper)).any():
            raise StudyError(f"{self._where}: segment {segment} ends outside its own range of positions")
        return limits

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return int(self.waypoints.shape[1])

    @property
    def n_waypoints(self) -> int:
        """Number of waypoints."""
        return len(self.waypoints)

    @property
    def n_segments(self) -> int:
        """Number of segments between waypoints."""
        return len(self.waypoints) - 1

    @property
    def moving(self) -> NDArray[np.bool_]:
        """Mask of the moving joints, shape (n_joints,): their waypoints span more than the floor of `study.tolerances`."""
        return np.ptp(self.waypoints, axis=0) > floors(self.waypoints)

    @property
    def position_tolerance(self) -> Floats:
        """Distance that counts as rounding in a position, shape (n_joints,), rad or m."""
        return np.maximum(TOLERANCE * np.ptp(self.waypoints, axis=0), floors(self.waypoints))

    @property
    def tolerances(self) -> Floats:
        """Granted distance from every waypoint, shape (n_waypoints, n_joints), rad or m."""
        return np.zeros_like(self.waypoints) if self.tolerance is None else self.tolerance

    @cached_property
    def end_states(self) -> tuple[State, State]:
        """Rates demanded at the first and at the last instant."""
        given = (self.end if state is None else state for state in (self.start, self.finish))
        first, last = (State.under(s, self.n_joints) if isinstance(s, EndCondition) else s for s in given)
        return first, last

    @property
    def scalable(self) -> bool:
        """Whether a slower run of a motion still meets the demands at its ends: their rates are zero or free."""
        return not any(state.moving for state in self.end_states)

    @cached_property
    def demands(self) -> frozenset[Demand]:
        """Everything that the problem asks of a motion beyond passing the waypoints."""
        return frozenset(demand for demand, holds in _asked(self) if holds)

    @property
    def planner_demands(self) -> frozenset[Demand]:
        """Demands that a planner must see to itself: where a slower run is allowed, any motion can be fitted to the others."""
        return self.demands - (ARM | {Demand.DURATION, Demand.CYCLE} if self.scalable else set())

    def joint(self, index: int) -> Problem:
        """Take the problem of one joint alone, without limits of the whole arm; its neighbouring waypoints may be equal."""
        index_in(index, range(self.n_joints), f"{self._where}: joint")
        return replace(
            self,
            name=f"{self.name}, {self.joint_names[index]}",
            waypoints=self.waypoints[:, index : index + 1],
            limits=self.limits.joint(index),
            joint_names=(self.joint_names[index],),
            allow_dwell=True,
            start=alone(self.start, index),
            finish=alone(self.finish, index),
            segment_limits={k: limits.joint(index) for k, limits in self.segment_limits.items()},
            tolerance=self.tolerances[:, index : index + 1],
            path=None if self.path is None else self.path.joint(index),
            arm=None,
        )

    def at_speed(self, share: float) -> Problem:
        """Take limits under which every motion runs at this share of its speed; those of torque stay as they are."""
        factor = 1.0 / positive(share, f"{self._where}: speed")
        return replace(
            self,
            limits=self.limits.scaled(factor),
            segment_limits={k: limits.scaled(factor) for k, limits in self.segment_limits.items()},
            duration_bounds=(self.duration_bounds[0] * factor, self.duration_bounds[1] * factor),
            arm=None if self.arm is None else self.arm.scaled(factor),
        )


_KINDS: dict[str, tuple[type, ...]] = {
    "limits": (JointLimits,),
    "end": (EndCondition,),
    "start": (State, EndCondition, type(None)),
    "finish": (State, EndCondition, type(None)),
    "dwells": (Mapping, type(None)),
    "segment_limits": (Mapping, type(None)),
    "stops": (Sequence, np.ndarray),
    "joint_names": (Sequence, np.ndarray),
    "path": (StraightPath, Tube, type(None)),
    "timing": (Timing, type(None)),
    "arm": (ArmLimits, type(None)),
}


def _asked(problem: Problem) -> list[tuple[Demand, bool]]:
    robot, timing = problem.limits, problem.timing or Timing()
    finite = [bool(np.isfinite(rates).any()) for rates in robot.rates]
    return [
        *zip((Demand.VELOCITY, Demand.ACCELERATION, Demand.JERK), finite, strict=True),
        (Demand.POSITION_RANGE, bool(np.isfinite([robot.lower, robot.upper]).any())),
        (Demand.DIRECTIONAL_LIMITS, not all(bounds.symmetric for bounds in (robot, *problem.segment_limits.values()))),
        (Demand.SEGMENT_LIMITS, bool(problem.segment_limits)),
        (Demand.MOVING_ENDS, not problem.scalable),
        (Demand.DIFFERENT_ENDS, problem.scalable and (problem.start is not None or problem.finish is not None)),
        (Demand.STOPS, bool(problem.stops)),
        (Demand.DWELLS, bool(problem.dwells)),
        (Demand.TOLERANCE, bool(problem.tolerances.any())),
        (Demand.STRAIGHT_PATH, isinstance(problem.path, StraightPath)),
        (Demand.TUBE, isinstance(problem.path, Tube)),
        *((demand, problem.arm is not None and demand in problem.arm.demands) for demand in sorted(ARM)),
        (Demand.DURATION, timing.exactly is not None or timing.at_least is not None),
        (Demand.CYCLE, timing.cycle is not None),
    ]
