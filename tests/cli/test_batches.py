"""Several files on one command line, several problems from Python, and plans from a moving arm."""

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError, onward, plan, plan_many
from study.__main__ import main

FOUR = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
LIMITS = JointLimits(np.array([1.0, 0.8]), np.array([2.0, 1.5]), np.array([20.0, 15.0]))


def written(folder, name, points):
    path = folder / f"{name}.yaml"
    path.write_text(
        f"name: {name}\nwaypoints: {np.asarray(points).tolist()}\nunits: rad\nlimits: {{velocity: [1, 1], acceleration: [2, 2]}}\n"
    )
    return str(path)


def run(monkeypatch, *arguments):
    monkeypatch.setattr("sys.argv", ["study", *arguments])
    try:
        main()
    except SystemExit as end:
        return end.code or 0
    return 0


def test_several_files_are_planned_and_a_broken_one_does_not_stop_the_rest(tmp_path, monkeypatch, capfd):
    first, last = written(tmp_path, "first", FOUR), written(tmp_path, "last", FOUR[::-1])
    out = tmp_path / "out"
    missing = str(tmp_path / "missing.yaml")
    assert run(monkeypatch, "plan", first, missing, last, "--planner", "fast", "--out", str(out)) == 2
    assert {path.stem for path in (out / "trajectories").glob("*.csv")} == {"first", "last"}
    assert "missing.yaml" in capfd.readouterr().err
    assert run(monkeypatch, "plan", first, last, "--save", str(tmp_path / "a.csv")) == 2
    assert "--save takes one FILE" in capfd.readouterr().err


def test_many_problems_come_back_in_their_order():
    problems = [Problem(f"p{k}", FOUR * (1 + k), LIMITS) for k in range(3)]
    here = plan_many(problems, "fast")
    assert [planned.problem.name for planned in here] == ["p0", "p1", "p2"]
    assert here[0].duration == plan(problems[0], "fast").duration < here[1].duration < here[2].duration
    with pytest.raises(StudyError, match="jobs must be a whole number of at least 1"):
        plan_many(problems, jobs=0)


@pytest.mark.slow
def test_many_problems_in_workers_are_the_same(monkeypatch):
    monkeypatch.setenv("STUDY_ENGINE", "numpy")  # workers would take the compiled one only where its cache is
    problems = [Problem(f"p{k}", FOUR * (1 + k), LIMITS) for k in range(3)]
    assert [p.duration for p in plan_many(problems, "fast", jobs=2)] == [
        p.duration for p in plan_many(problems, "fast")
    ]


@pytest.mark.parametrize("limits", [LIMITS, JointLimits(LIMITS.velocity, LIMITS.acceleration)])
def test_a_moving_arm_goes_on_from_where_it_is(limits):
    motion = plan(Problem("mine", FOUR, limits), "fast").motion
    asked = onward(Problem("mine", FOUR, limits), motion, 0.4 * motion.duration, FOUR[2:] + 0.3)
    answer = plan(asked, "fast")
    assert answer.feasible
    for order in range(2 if limits is not LIMITS else 3):
        np.testing.assert_allclose(
            answer.motion(np.zeros(1), order)[0], motion(np.array([0.4 * motion.duration]), order)[0], atol=1e-9
        )
    assert asked.end_states[1].condition is not EndCondition.FREE
    np.testing.assert_allclose(answer.motion(np.array([answer.motion.duration]), 1)[0], 0.0, atol=1e-9)
