"""`plan` and `compare` from Python, and the commands for one's own robot."""

import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

import study
from baselines.base import Deterministic
from study import Comparison, EndCondition, JointLimits, Planned, Problem, StudyError, compare, judge, plan
from study.api import automatic
from study.cautions import cautions, ends_said
from study.io.exact import read_exact
from study.planning import Plan, RunSettings, Status
from study.registry import planner_about
from study.runs.selections import AUTO, AUTO_UNBOUNDED, AUTO_WITHOUT_JERK
from tests.helpers.robot_files import MOVEIT

FOUR = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
V, A, J = np.array([1.0, 0.8]), np.array([2.0, 1.5]), np.array([20.0, 15.0])


@pytest.mark.parametrize(
    ("limits", "tried"),
    [(JointLimits(V), AUTO_UNBOUNDED), (JointLimits(V, A), AUTO_WITHOUT_JERK), (JointLimits(V, A, J), AUTO)],
)
def test_auto_gives_the_fastest_motion_of_all_that_it_tried(limits, tried):
    planned = plan(Problem("mine", FOUR, limits))
    assert (*(name for name, _, _ in planned.tried), *planned.spared) == tried == automatic(planned.problem)
    feasible = [result.verdict.duration for _, _, result in planned.tried if result.verdict.feasible]
    assert planned.feasible
    assert planned.duration == min(feasible)
    lead = f"the fastest of {len(feasible)} feasible motions"
    if len(feasible) == 1:
        lead = f"the fastest of all, for ruckig-stops takes at least {planned.spared['ruckig-stops']:.4g} s"
    assert planned.why.startswith(f"{lead}: {planner_about(planned.planner)}")
    assert planned.verdict.worst_ratio == pytest.approx(1.0, abs=1e-6)
    assert judge(planned.problem, planned.motion).duration == planned.duration


@pytest.mark.parametrize("limits", [JointLimits(V), JointLimits(V, A), JointLimits(V, A, J)])
def test_best_never_ends_above_fast(limits):
    problem = Problem("mine", np.vstack([FOUR, FOUR[:2] + 1.5]), limits)
    fast, best = plan(problem, "fast"), plan(problem, "best")
    assert (fast.tier, best.tier) == ("fast", "best")
    assert fast.feasible
    assert best.duration <= fast.duration <= plan(problem, "ruckig-stops").duration
    assert plan(problem).duration == best.duration


def test_fast_is_never_longer_than_a_stop_at_every_waypoint():
    problem = Problem("wild", np.random.default_rng(0).uniform(-1, 1, (4, 2)), JointLimits([1.0, 1.0], [9.0, 9.0]))
    fast = plan(problem, "fast")
    assert fast.planner == "ruckig-stops"
    assert fast.duration < plan(problem, "toppra-quick").duration
    assert fast.why.startswith("the fastest of 2 feasible motions: Ruckig from waypoint to waypoint")


def test_fast_stays_in_a_range_that_the_usual_spline_leaves():
    tight = JointLimits(V, A, None, FOUR.min(axis=0) - 1e-4, FOUR.max(axis=0) + 1e-4)
    planned = plan(Problem("tight", FOUR, tight), "fast")
    assert [name for name, _, _ in planned.tried] == ["toppra-quick"]
    assert planned.why.startswith("the first feasible motion: TOPP-RA")
    assert plan(planned.problem).duration <= planned.duration


@pytest.mark.parametrize("limits", [JointLimits(V, A), JointLimits(V, A, J)])
def test_a_single_move_from_rest_to_rest_needs_no_search(limits):
    planned = plan(Problem("move", FOUR[:2], limits))
    assert [name for name, _, _ in planned.tried] == ["ruckig-stops"]
    assert planned.why.startswith("no move from rest to rest is faster")
    assert plan(planned.problem, "free-path").duration >= planned.duration * (1 - 1e-6)
    stepping = Problem("step", FOUR[:2], JointLimits(V, A, J), EndCondition.REST)
    assert plan(stepping).duration < plan(stepping, "ruckig-stops").duration


def test_auto_tries_its_reserve_where_the_arm_would_stop_everywhere(monkeypatch):
    monkeypatch.setattr("study.api.automatic", lambda problem: ("toppra", "certified", "ruckig-stops"))
    monkeypatch.setattr("study.api.AUTO_RESERVE", ("topp3-nlp",))
    planned = plan(Problem("mine", np.vstack([FOUR, FOUR + 0.1]), JointLimits(V, A, J)))
    assert [name for name, _, _ in planned.tried] == ["toppra", "certified", "ruckig-stops", "topp3-nlp"]
    assert planned.feasible
    assert planned.duration <= planned.tried[2][2].verdict.duration
    assert "acceleration of joint 2 jumps" in planned.tried[0][2].verdict.reasons[0]
    assert planned.tried[1][2].message


def test_auto_says_why_the_arm_stops_at_every_waypoint(monkeypatch):
    monkeypatch.setattr("study.api.automatic", lambda problem: ("toppra", "ruckig-stops"))
    monkeypatch.setattr("study.api.AUTO_RESERVE", ())
    problem = Problem("mine", FOUR, JointLimits(V, A, J))
    planned = plan(problem)
    assert planned.planner == "ruckig-stops"
    assert planned.why.startswith("the only feasible motion that was found: Ruckig from waypoint to waypoint")
    assert "it stops at every waypoint, because toppra: acceleration of joint" in planned.why
    assert plan(problem, "ruckig-stops").why == (
        f"it was asked for: {planner_about('ruckig-stops')}; it stops at every waypoint, because nothing that was tried is faster"
    )


def test_nothing_feasible_is_said_to_break_the_limits_least(monkeypatch):
    monkeypatch.setattr("study.api.automatic", lambda problem: ("toppra",))
    monkeypatch.setattr("study.api.AUTO_RESERVE", ("certified",))
    planned = plan(Problem("mine", np.vstack([FOUR, FOUR + 0.1]), JointLimits(V, A, J)))
    assert [name for name, _, _ in planned.tried] == ["toppra", "certified"]
    assert (planned.planner, planned.feasible) == ("toppra", False)
    assert planned.why == "no motion keeps the limits, and this one breaks them least"


def test_velocity_limits_alone_are_warned_of_and_no_file_is_written_unasked(tmp_path):
    problem = Problem("mine", FOUR, JointLimits(V))
    planned = plan(problem)
    warning = (
        "no joint has an acceleration limit, so speed may change in an instant, also at the start and at the end: "
    )
    assert planned.warnings == (warning + "no arm can follow such a motion",)
    assert str(compare(problem, ["ruckig-stops"])).startswith(warning)
    with pytest.raises(StudyError, match=r"no arm can follow.*nothing is written for a controller"):
        planned.write(tmp_path / "a.yaml")
    assert not (tmp_path / "a.yaml").exists()
    assert planned.write(tmp_path / "a.yaml", accept_unbounded_acceleration=True).exists()
    bounded = plan(Problem("mine", FOUR, JointLimits(V, A)), "ruckig-stops")
    assert bounded.warnings == ()
    assert bounded.write(tmp_path / "b.yaml").exists()


def test_at_rest_is_said_only_where_the_judge_holds_the_motion_to_it():
    half = JointLimits(V, np.array([2.0, np.inf]))
    said = {limits: ends_said(Problem("p", FOUR, limits)) for limits in (JointLimits(V), half, JointLimits(V, A))}
    assert list(said.values()) == [
        "may start and end at full speed, because no joint has an acceleration limit",
        "starts and ends at rest, but joint 2 may start and end at full speed without an acceleration limit",
        "starts and ends at rest",
    ]
    assert cautions(Problem("p", FOUR, half))[0].startswith("joint 2 has no acceleration limit, so speed may change")
    still = np.column_stack([FOUR[:, 0], np.zeros(4)])
    assert cautions(Problem("p", still, half)) == ()
    assert ends_said(Problem("p", FOUR, JointLimits(V), EndCondition.FREE)) == "may start and end in motion"


def test_answers_are_shown_in_three_lines():
    problem = Problem("mine", FOUR, JointLimits(V, A))
    planned, compared = plan(problem, "ruckig-stops"), compare(problem, ["ruckig-stops", "toppra"])
    assert repr(planned).splitlines() == [
        f"Planned 'mine': {planned.duration:.6g} s by ruckig-stops, feasible, at most {planned.deviation:.4g} rad or m "
        "from the straight lines",
        "tried: ruckig-stops",
        "warnings: none",
    ]
    assert repr(compared).splitlines()[0] == "Comparison on 'mine': 2 runs, 2 feasible"
    assert len(repr(compared).splitlines()) == len(repr(plan(problem, "certified")).splitlines()) == 3


def test_auto_keeps_a_narrow_range_of_positions():
    waypoints = np.array([[0.0], [1.0], [1.0 - 1e-3], [0.0]])
    limits = JointLimits(np.array([1.0]), np.array([1.0]), np.array([5.0]), np.array([0.0]), np.array([1.0]))
    planned = plan(Problem("tight", waypoints, limits))
    assert planned.feasible
    assert planned.motion.extrema().highest[0] <= 1.0 + 1e-9
    assert not plan(planned.problem, "free-path-nlp").feasible


def test_only_limits_of_joints_that_move_count():
    waypoints = np.column_stack([FOUR, np.zeros(4)])
    limits = JointLimits(np.ones(3), np.array([np.inf, np.inf, 1.0]))
    assert automatic(Problem("still", waypoints, limits)) == AUTO_UNBOUNDED


def test_a_planner_can_be_named_and_its_failure_has_a_reason():
    planned = plan(Problem("mine", FOUR, JointLimits(V)), "toppra")
    assert not planned.feasible
    assert planned.duration == np.inf
    assert "no acceleration limit" in planned.reason
    with pytest.raises(StudyError, match="no acceleration limit"):
        _ = planned.motion
    with pytest.raises(StudyError, match="no acceleration limit"):
        _ = planned.verdict
    with pytest.raises(StudyError, match="did you mean 'toppra'"):
        plan(planned.problem, "topra")


def test_compare_ranks_feasible_motions_first():
    comparison = compare(
        Problem("mine", FOUR, JointLimits(V, A, J), EndCondition.REST),
        ["toppra", "ruckig-stops", "golds-pso", "casadi-nlp"],
        seeds=2,
    )
    assert [result.cell.planner for result in comparison.results][-1] == "toppra"
    assert comparison.best.cell.planner == "casadi-nlp"
    durations = [r.verdict.duration for r in comparison.results if r.verdict.feasible]
    assert durations == sorted(durations)
    assert len(str(comparison).splitlines()) == 5
    assert {r.cell.settings.seed for r in comparison.results if r.cell.planner == "golds-pso"} == {0, 1}


def test_compare_needs_something_to_compare():
    problem = Problem("mine", FOUR, JointLimits(V))
    for arguments, sentence in (({"planners": []}, "at least one planner's name"), ({"seeds": 0}, "seeds")):
        with pytest.raises(StudyError, match=sentence):
            compare(problem, **arguments)
    with pytest.raises(StudyError, match="no planner 'nonsense'"):
        compare(problem, ["nonsense"])
    assert compare(problem, ["toppra"]).best is None


def test_duration_bounds_follow_the_problem():
    for scale in (1e-6, 1.0, 3600.0):
        limits = JointLimits(V, A, J).scaled(scale)
        problem = Problem("scaled", FOUR, limits)
        lower, upper = problem.duration_bounds
        assert lower == pytest.approx(0.5 * scale)
        fastest = np.diff(plan(problem).motion.waypoint_times)
        assert (fastest >= lower).all()
        assert (fastest <= upper).all()


def test_everything_exported_is_documented_and_typed():
    for name in study.__all__:
        assert getattr(study, name).__doc__, name
    assert {"Problem", "plan", "compare", "judge", "Trajectory"} <= set(study.__all__)
    assert (Path(study.__file__).parent / "py.typed").exists()
    assert Planned.__doc__
    assert Comparison.__doc__


WITHOUT = """
import importlib.abc, sys
class Missing(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name.partition(".")[0] not in {allowed!r} and name.partition(".")[0] in {known!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)
sys.meta_path.insert(0, Missing())
"""
KNOWN = {
    "pydantic",
    "yaml",
    "typer",
    "rich",
    "toppra",
    "ruckig",
    "rerun",
    "matplotlib",
    "pandas",
    "pyarrow",
    "jinja2",
} | {
    "copp_py",
    "cmaes",
}


def without_packages(code):
    blocked = WITHOUT.format(allowed=set(), known=KNOWN)
    return subprocess.run([sys.executable, "-c", blocked + code], capture_output=True, text=True, timeout=60)


def test_numpy_scipy_and_casadi_are_enough_for_python():
    code = """
import numpy as np
from study import JointLimits, Problem, compare, plan
problem = Problem("mine", np.array([[0.0, 0], [1, 1], [0.5, 2]]), JointLimits(np.ones(2), 2 * np.ones(2)))
print(plan(problem).duration, plan(problem, "ruckig-stops").reason, compare(problem), sep="\\n")
"""
    ended = without_packages(code)
    assert ended.returncode == 0, ended.stderr
    assert ended.stdout.startswith("2.58")
    assert "needs the Python package 'ruckig', which is not installed; install it with pip" in ended.stdout


@pytest.mark.parametrize(
    ("code", "sentence"),
    [
        (
            "from study.adapters import objective",
            "need the Python packages pydantic and pyyaml; install them with: pip",
        ),
        ("from study.cases.library import load_case", "need the Python packages pydantic and pyyaml"),
        (
            "from study.io.recordings import read_samples; from pathlib import Path; read_samples(Path('a.yaml'))",
            "pip install pyyaml",
        ),
    ],
)
def test_what_needs_more_packages_names_them(code, sentence, tmp_path):
    (tmp_path / "a.yaml").write_text("- [1, 2]\n")
    ended = without_packages(f"import os; os.chdir({str(tmp_path)!r})\n{code}")
    assert ended.returncode == 1
    assert sentence in ended.stderr.splitlines()[-1]


@pytest.mark.parametrize("planner", ["toppra", "copp", "cma-es", "ruckig-via"])
def test_a_planner_without_its_package_is_a_result_with_a_reason(planner):
    code = f"""
import numpy as np
from study import JointLimits, Problem, plan
limits = JointLimits(np.ones(2), 2 * np.ones(2), 9 * np.ones(2))
print(plan(Problem("mine", np.array([[0.0, 0], [1, 1], [0.5, 2]]), limits), {planner!r}).reason)
"""
    ended = without_packages(code)
    assert ended.returncode == 0, ended.stderr
    assert "install it with" in ended.stdout


def test_the_command_says_what_it_lacks():
    ended = without_packages("from study.__main__ import main; main()")
    assert ended.returncode == 2
    assert ended.stderr.startswith("study: the command needs the Python package 'typer', which is not installed")
    assert ended.stderr.count("\n") == 1


def test_a_missing_file_of_ours_is_not_taken_for_a_package():
    code = "import sys; sys.argv = ['study', 'list']; sys.modules['study.cli.terminal'] = None\nfrom study.__main__ import main; main()"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.returncode == 1
    assert "ModuleNotFoundError" in ended.stderr


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.yaml"
    path.write_text(
        "units: rad\nwaypoints: [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]]\n"
        "limits: {velocity: [1.0, 0.8], acceleration: [2.0, 1.5]}\n"
    )
    return path


def test_init_check_plan(tmp_path, study_command):
    ended = study_command("init", cwd=tmp_path)
    assert ended.returncode == 0
    again = study_command("init", cwd=tmp_path)
    assert again.returncode == 2
    assert again.stderr == "study: file 'my_case.yaml' exists already; name another one or move it away\n"
    checked = study_command("check", "my_case.yaml", cwd=tmp_path)
    assert "planner auto tries free-path: free path in pieces" in checked.stdout
    assert "the case is complete" in checked.stdout
    planned = study_command("plan", "my_case.yaml", "--planner", "casadi-nlp", "--rate", 50, cwd=tmp_path)
    assert planned.returncode == 0, planned.stderr
    written = {path.name for path in (tmp_path / "study-output" / "trajectories").iterdir()}
    assert written == {"my_case.yaml", "my_case.csv", "my_case.npz", "my_case.exact.json"}
    for name in ("my_case.csv", "my_case.exact.json"):
        judged = study_command("check", f"study-output/trajectories/{name}", "--case", "my_case.yaml", cwd=tmp_path)
        assert re.search(r"my_case +3\.3538\d* s, (may|must not) be driven", judged.stdout)
    assert judged.returncode == 0
    assert "feasible" in judged.stdout


def test_plan_says_why_and_saves_where_told(small, study_command, tmp_path):
    ended = study_command("plan", small, "--save", tmp_path / "a.csv", "--save", tmp_path / "b.exact.json")
    assert ended.returncode == 0, ended.stderr
    assert "tried free-path (free path in pieces" in ended.stdout
    assert "the fastest of " in ended.stdout
    assert read_exact(tmp_path / "b.exact.json").duration == pytest.approx(2.62, rel=0.05)


def test_plan_ends_with_3_where_there_is_no_feasible_motion(small, study_command):
    small.write_text(small.read_text().replace("acceleration: [2.0, 1.5]", "acceleration: 2.0, jerk: 1.0"))
    ended = study_command("plan", small, "--planner", "toppra")
    assert ended.returncode == 3
    assert "no feasible motion: jerk of joint" in ended.stdout
    assert ended.stderr == "study: case 'small': no feasible motion was found; the reasons are above\n"


def test_compare_leaves_trajectory_and_results(small, study_command, tmp_path, threads):
    arguments = ["compare", small, "--planners", "casadi-nlp,ruckig-stops", "--no-report", "--out", tmp_path / "out"]
    ended = study_command(*arguments)
    assert ended.returncode == 0, ended.stderr
    assert "planner  ruckig-stops" in ended.stdout
    message = yaml.safe_load((tmp_path / "out" / "trajectories" / "small.yaml").read_text())
    assert message["points"][-1]["velocities"] == pytest.approx([0, 0], abs=1e-9)
    assert "2 cells, 2 stored already" in study_command(*arguments).stdout


def test_a_motion_of_microseconds_is_told_and_sampled_as_such(study_command, tmp_path, threads):
    path = tmp_path / "fast.json"
    limits = {"velocity": 1e6, "acceleration": 2e12, "jerk": 3e19}
    path.write_text(json.dumps({"units": "rad", "waypoints": [[0, 0], [1, 0.5], [0, 1]], "limits": limits}))
    arguments = [path, "--planner", "ruckig-stops", "--save", "fast.csv"]
    planned = study_command("plan", *arguments, cwd=tmp_path)
    assert planned.returncode == 0, planned.stderr
    assert re.search(r"passed at 0\.0000000000, 0\.00000\d{5}, 0\.00000\d{5} s", planned.stdout)
    assert 10 < len((tmp_path / "fast.csv").read_text().splitlines()) < 1000
    compared = study_command("compare", path, "--planners", "ruckig-stops", "--no-report", cwd=tmp_path)
    assert re.search(r" \d\.\d+e-06 ", compared.stdout), compared.stdout


def test_waypoints_alone_with_limits_from_a_robots_files(study_command, tmp_path, threads):
    limits = MOVEIT.replace("max_velocity: 1e0", "max_velocity: 1e0\n    max_acceleration: 2.0")
    (tmp_path / "joint_limits.yaml").write_text(limits)
    (tmp_path / "points.csv").write_text("panda_joint1;joint <2>\r\n0;0\r\n30;40,5\r\n60;0\r\n")
    arguments = ["points.csv", "--limits", "joint_limits.yaml", "--units", "deg"]
    ended = study_command("plan", *arguments, "--save", "out.json", cwd=tmp_path)
    assert ended.returncode == 0, ended.stderr
    assert json.loads((tmp_path / "out.json").read_text())["joint_names"] == ["panda_joint1", "joint <2>"]
    checked = study_command("check", *arguments, cwd=tmp_path)
    assert checked.returncode == 0, checked.stderr
    assert "the case is complete" in checked.stdout
    compared = study_command("compare", *arguments, "--planners", "ruckig-stops", "--no-report", cwd=tmp_path)
    assert compared.returncode == 0, compared.stderr
    assert study_command("report", cwd=tmp_path).returncode == 0
    bare = study_command("plan", "points.csv", cwd=tmp_path)
    assert bare.returncode == 2
    assert "holds waypoints only; add --limits" in bare.stderr


def test_a_joint_without_an_acceleration_limit_is_warned_of_first_and_writes_no_file(study_command, tmp_path, threads):
    (tmp_path / "fast.yaml").write_text(
        "units: rad\nwaypoints: [[0, 0], [1, 0.5], [0.2, 0.4]]\nlimits: {velocity: [2, 1]}\n"
    )
    checked = study_command("check", "fast.yaml", cwd=tmp_path)
    assert checked.stdout.startswith("warning: no joint has an acceleration limit")
    assert "at rest" not in checked.stdout
    for command in (("plan", "fast.yaml"), ("compare", "fast.yaml", "--planners", "ruckig-stops", "--no-report")):
        ended = study_command(*command, cwd=tmp_path)
        assert ended.stdout.startswith("warning: no joint has an acceleration limit"), command
        assert ended.returncode == 2
        assert "nothing is written for a controller" in ended.stderr
        assert not (tmp_path / "study-output" / "trajectories").exists()
    accepted = study_command("plan", "fast.yaml", "--accept-unbounded-acceleration", cwd=tmp_path)
    assert accepted.returncode == 0, accepted.stderr
    assert (tmp_path / "study-output" / "trajectories" / "fast.yaml").is_file()


def test_a_mistake_is_one_sentence_and_exit_code_2(small, study_command, tmp_path):
    for arguments, sentence in {
        ("plan", "nothing.yaml"): "does not exist",
        ("check", "samples.csv"): "does not exist",
        ("plan", small, "--units", "deg"): "go with waypoints alone",
        ("plan", small, "--planner", "nonsense"): "no planner 'nonsense'",
        ("plan", small, "--save", "a.mat"): "must end in one of",
        ("compare", small, "--seeds", "0"): "number of seeds must be at least 1",
    }.items():
        ended = study_command(*arguments, cwd=tmp_path)
        assert ended.returncode == 2, arguments
        assert sentence in ended.stderr
        assert ended.stderr.count("\n") == 1


def test_the_schema_is_printed_as_json(study_command):
    printed = json.loads(study_command("schema").stdout)
    assert {"units", "waypoints", "limits"} <= set(printed["properties"])
    assert "from" in json.dumps(printed)


def test_end_condition_decides_the_curve():
    from study.planning import usual_curve

    problems = {end: Problem("p", FOUR, JointLimits(V, A, J), end) for end in EndCondition}
    assert [usual_curve(problems[end]) for end in EndCondition] == [
        "cubic-spline",
        "cubic-spline",
        "cubic-spline-smooth",
    ]
    assert usual_curve(Problem("p", FOUR[:3], JointLimits(V, A, J), EndCondition.SMOOTH)) == "cubic-spline-smooth"


@pytest.mark.parametrize("first", ["study.judge", "study.api", "sys"])
def test_the_judge_is_a_function_whatever_was_imported_before(first):
    code = f"import {first}; import study; from study import judge, plan; print(callable(judge), study.judge is judge)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert ended.stdout.split() == ["True", "True"], ended.stderr


def test_a_tier_has_one_time_limit(monkeypatch):
    given = []

    class Slow(Deterministic):
        about = "takes its time"

        def plan(self, problem, settings):
            given.append(settings.time_limit)
            clock.append(clock[-1] + 4.0)
            return Plan(Status.FAILED, message="nothing")

    clock = [0.0]
    monkeypatch.setattr("study.deadline.time", SimpleNamespace(monotonic=lambda: clock[-1]))
    monkeypatch.setattr("study.runs.execute.method_named", lambda name: Slow())
    settings = RunSettings("cubic-spline", time_limit=10.0)
    planned = plan(Problem("mine", FOUR, JointLimits(V, A, J)), "best", settings)
    assert given == [10.0, 6.0, 2.0, pytest.approx(0.1)]
    assert {result.cell.settings.time_limit for _, _, result in planned.tried} == {10.0}
