"""Torques along the papers' motions and the planners': what limits of velocity and acceleration alone leave out."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from study.analysis.published import published_result
from study.arm_findings import enclosed
from study.bench.planner_parts import Part, Told
from study.cases.case import Case
from study.cases.library import case_names, load_case
from study.errors import listed
from study.files import write_file
from study.judge import judge
from study.problem import Floats, Problem
from study.registry import planner_about, planner_named, unavailable_planners
from study.robots.masses import heavy_arm
from study.runs.execute import asked
from study.trajectory import Motion

CASES = ("puma560-torque", "ur5-bspline-torque")
PLANNERS = ("casadi-nlp", "free-path", "toppra")
SAMPLES = 400
"""Instants of every motion in the figure."""


@dataclass(frozen=True, eq=False)
class Loaded:
    """A motion and what it asks of the motors.

    Attributes
    ----------
    case, label : str
    motion : Motion, optional
    held : bool
        Whether it was planned within the limits of torque.
    share : float
        Proved bound of the largest share of a torque limit, but for steps of velocity.
    joint : str
        Joint that has it.
    steps : bool
        Whether a velocity steps, from rest or inside: an infinite torque for an instant.
    """

    case: str
    label: str
    motion: Motion | None
    held: bool
    share: float
    joint: str
    steps: bool

    @property
    def duration(self) -> float:
        """Duration of the motion, s; not a number where there is none."""
        return np.nan if self.motion is None else self.motion.duration


def torque(seed: int, told: Told) -> Part:
    """Torques of the papers' motions and of the planners', which know the limits of torque or not."""
    rows = tuple(loaded(told))
    return Part("Largest share of a torque limit", HEAD, tuple(map(_cells, rows)), tuple(sentences(rows)))


HEAD = ("case", "motion", "torque limits", "duration s", "largest share", "joint")


def loaded(told: Told) -> Iterator[Loaded]:
    """Motions of the papers and of planners, without limits of torque and within them, one after the other."""
    for name in CASES:
        case = load_case(name)
        told(name)
        yield from _papers(case)
        for planner in PLANNERS:
            if planner in unavailable_planners():
                continue
            for held, problem in ((False, replace(case.problem, arm=None)), (True, case.problem)):
                told(f"{name}, {planner}")
                plan = asked(planner_named(planner), problem, case.settings)
                motion = plan.motion if plan.motion is not None and judge(problem, plan.motion).feasible else None
                yield _row(case.problem, planner, motion, held)


def _papers(case: Case) -> Iterator[Loaded]:
    paper = load_case(case.variant_of)
    for printed in paper.published:
        if printed.durations is not None and printed.joint is None:
            motion = published_result(paper, printed, printed.label).motion
            yield _row(case.problem, f"paper: {printed.label}", motion, False)


def _row(problem: Problem, label: str, motion: Motion | None, held: bool) -> Loaded:
    if problem.arm is None or motion is None:
        return Loaded(problem.name, label, None, held, np.nan, "", False)
    shares = enclosed(problem.arm, motion).highest[:-2]
    joint = int(shares.argmax())
    return Loaded(problem.name, label, motion, held, float(shares[joint]), problem.joint_names[joint], _steps(motion))


def _steps(motion: Motion) -> bool:
    """Whether a velocity steps."""
    peak = motion.extrema(1).peak.max()
    ends = np.abs(motion([0.0, motion.duration], 1)).max()
    return bool(max(ends, np.abs(motion.jumps(1)).max(initial=0.0)) > 1e-6 * peak)


def _cells(row: Loaded) -> tuple[str, ...]:
    known = "kept" if row.held else "not known"
    if row.motion is None:
        return row.case, row.label, known, "no motion", "", ""
    share = f"{100 * row.share:.1f} %{', infinite where the velocity steps' if row.steps else ''}"
    return row.case, row.label, known, f"{row.motion.duration:.4f}", share, row.joint


def sentences(rows: Sequence[Loaded]) -> Iterator[str]:
    """Say what the table shows, and of which arms nothing can be said."""
    for name in CASES:
        own = [row for row in rows if row.case == name and row.motion is not None]
        papers = [row.share for row in own if row.label.startswith("paper")]
        held = load_case(name).problem.arm
        alone = 0.0 if held is None else float(held.held(load_case(name).problem.waypoints).max())
        if papers:
            yield (
                f"{name}: the paper's motions use at most {max(papers):.1%} of a torque limit, and gravity alone at the waypoints "
                f"{alone:.1%}."
            )
        for planner in PLANNERS:
            pair = {row.held: row for row in own if row.label == planner}
            if len(pair) == 2:
                stepping = ", where without them the velocity steps" if pair[False].steps else ""
                longer = pair[True].duration / pair[False].duration - 1
                yield f"{name}, {planner}: limits of torque cost {longer:.1%} of the time{stepping}."
    without = [name for name in case_names(default_only=True) if not _heavy(load_case(name))]
    yield f"No masses are published of the arms of {listed(without)} as the papers describe them, so nothing is said of those motions."


def _heavy(case: Case) -> bool:
    return case.robot is not None and heavy_arm(case.robot).mechanism.heavy


def profiles(rows: Sequence[Loaded], case: str) -> list[tuple[str, Floats, Floats]]:
    """Label, shares of the duration and largest share of a torque limit at each, of every motion of a case."""
    problem, inside = load_case(case).problem, np.linspace(0.0, 1.0, SAMPLES)
    result = []
    for row in rows:
        if row.case == case and row.motion is not None and problem.arm is not None:
            rates = (row.motion(inside * row.motion.duration, order) for order in range(3))
            shares = np.abs(problem.arm.mechanism.torque(*rates)) / problem.arm.torque
            label = f"{row.label}, {row.motion.duration:.3g} s{', torque kept' if row.held else ''}"
            result.append((label, inside, shares.max(axis=1)))
    return result


def write_page(rows: Sequence[Loaded], folder: Path) -> list[Path]:
    """Write the page about torques, `torque.md`, and its figure, `torque.svg`.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    from study.bench.figures import torques  # here: matplotlib is slow to import

    table = [f"| {' | '.join(HEAD)} |", f"|{'---|' * len(HEAD)}", *(f"| {' | '.join(_cells(row))} |" for row in rows)]
    planners = [f"`{name}`: {planner_about(name)}" for name in PLANNERS]
    lines = [
        *("# Torques that kinematic limits leave out", ""),
        "Made by `study bench --part torque --page FOLDER`. The papers limit velocities, and some accelerations; none asks whether",
        "the motors can do it. Masses are published of two of the arms, the PUMA 560 of the Robotics Toolbox and the UR5; the files",
        "`data/robots/puma560.yaml` and `data/robots/ur5.yaml` say where their numbers come from and what is not known. Torques are those",
        *(
            "of the arm without friction and payload.",
            "",
            "![Largest share of a torque limit along every motion](torque.svg)",
            "",
        ),
        *(*(f"- {sentence}" for sentence in sentences(rows)), "", *table, ""),
        "The largest share is a proved bound over the whole motion, one part in a thousand wide at most. A velocity that steps, as it may",
        "where nothing but velocities is limited, is an infinite torque for an instant.",
        *("", *(f"- {planner}" for planner in planners), ""),
    ]
    return [
        write_file(folder / "torque.md", "\n".join(lines)),
        write_file(folder / "torque.svg", torques({case: profiles(rows, case) for case in CASES})),
    ]
