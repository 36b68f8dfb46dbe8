"""The PUMA560 paper's claim that its motion avoids the obstacles, counted over many worlds.

The paper checks the segments of the tree. Here the straight chords between the four nodes that it keeps, and the tool along
the final curve, are checked apart; arm, start, goal and orientation are the paper's, the obstacles are ours.
"""

from __future__ import annotations

import numpy as np

from study.planners.rrt_spso import METHODS
from study.reproduction import rules
from study.reproduction.effort import Effort
from study.reproduction.jobs import RecordJob, Runs
from study.reproduction.path_runs import PathJob, attempts
from study.reproduction.verdicts import Rulings, claim

KINDS = {"collision-chords": "chords", "collision-free": "tool"}


def _attempts(method: str, effort: Effort) -> list[PathJob]:
    """Population and generations as on the paper's case; both are ours."""
    return attempts(method, effort.attempts, 30, effort.generations(100))


def jobs(effort: Effort) -> list[RecordJob]:
    """All worlds of all methods."""
    return [job for method in METHODS for job in _attempts(method, effort)]


def counted(runs: Runs, effort: Effort, method: str, kind: str) -> tuple[int, int]:
    """Worlds in which the chords or the tool collide, and worlds with a motion."""
    clearances = np.concatenate([np.array(runs[job][kind], dtype=float) for job in _attempts(method, effort)])
    return int((clearances <= 0).sum()), len(clearances)


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on chords and curve apart; stronger pathfinders stand beside."""
    gathered: Rulings = {}
    for identity, kind in KINDS.items():
        counts = {method: counted(runs, effort, method, kind) for method in METHODS}
        (collided, worlds), *_ = counts.values()
        others = {method: f"{hit} of {of}" for method, (hit, of) in counts.items() if method != METHODS[0]}
        why = (
            "the tree checks its own segments; four of its nodes are kept, and nothing checks what joins "
            "them; obstacles ours"
        )
        ruling = rules.holds(collided == 0, f"collide in {collided} of {worlds} worlds", why)
        gathered[claim(identity)] = ruling.beside(others)
    return gathered
