"""The PUMA560 paper's claim that its motion avoids the obstacles, counted over many worlds.

The paper checks the segments of the tree. Here the final curve is checked as well, for the tool point and for the whole arm.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from study.planners.rrt_spso import METHODS
from study.reproduction import rules
from study.reproduction.effort import Effort
from study.reproduction.jobs import RecordJob, Runs
from study.reproduction.path_runs import PathJob, attempts
from study.reproduction.verdicts import Rulings, claim


def _attempts(method: str, effort: Effort) -> list[PathJob]:
    """Population and generations as on the paper's case; both are ours."""
    return attempts(method, effort.attempts, 30, effort.generations(100))


def jobs(effort: Effort) -> list[RecordJob]:
    """All worlds of all methods."""
    return [job for method in METHODS for job in _attempts(method, effort)]


def counted(runs: Runs, effort: Effort, method: str) -> dict[str, int]:
    """Worlds with a motion, and in how many of them the tool, the arm and the arm at the waypoints collide."""
    records = [runs[job] for job in _attempts(method, effort)]
    clear = {
        key: np.concatenate([np.array(record[key], dtype=float) for record in records])
        for key in ("tool", "arm", "waypoints")
    }
    return {"worlds": len(clear["tool"])} | {key: int((values <= 0).sum()) for key, values in clear.items()}


def _fisher(one: dict[str, int], other: dict[str, int]) -> float:
    """Two-sided p-value that two methods' tools collide equally often."""
    table = np.array([[c["tool"], c["worlds"] - c["tool"]] for c in (one, other)])
    return float(stats.fisher_exact(table).pvalue)


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on the paper's statement and on the references beside it; the scene is ours."""
    counts = {method: counted(runs, effort, method) for method in METHODS}
    own = counts["rrt"]
    why = "our scene, since the paper's is not given; the tree checks the tool's segments, nothing checks the curve"
    found: Rulings = {}
    for identity, key in (("collision-free", "tool"), ("collision-free-arm", "arm")):
        text = f"collides in {own[key]} of {own['worlds']} worlds"
        if key == "arm":
            text += f" (already at the four waypoints in {own['waypoints']})"
        found[claim(identity)] = rules.holds(own[key] == 0, text, why)
    tests = {method: _fisher(one, own) for method, one in counts.items() if method != "rrt"}
    text = ", ".join(
        f"{method}: {counts[method]['tool']} of {counts[method]['worlds']} (p = {p:.2g})" for method, p in tests.items()
    )
    fewer = all(p < rules.SIGNIFICANT and counts[m]["tool"] < own["tool"] for m, p in tests.items())
    found[claim("collision-free-references")] = rules.holds(
        fewer, text, f"plain RRT: {own['tool']} of {own['worlds']}; Fisher's exact test"
    )
    return found
