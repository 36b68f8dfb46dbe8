"""Trajectories from the command line: wishes about time, no false alarm on our own files, and limits alone."""

import numpy as np
import pytest

from study.io.recordings import read_samples

LIMITS = "joint_limits:\n" + "".join(
    f"  {name}: {{has_velocity_limits: true, max_velocity: 1.0, has_acceleration_limits: true, max_acceleration: 2.0}}\n"
    for name in ("a", "b")
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "l.yaml").write_text(LIMITS)
    for name, jerk in (("smooth", ", jerk: 10"), ("stepped", "")):
        limits = f"{{velocity: 1, acceleration: 2{jerk}}}"
        rows = "[[0.0, 0.2], [0.5, -0.1], [0.9, 0.3]]"
        (tmp_path / f"{name}.yaml").write_text(f"units: rad\njoints: [a, b]\nwaypoints: {rows}\nlimits: {limits}\n")
    return tmp_path


def planned(study, folder, case, file, *options):
    ended = study("plan", f"{case}.yaml", "--planner", "ruckig-stops", "--save", file, *options, cwd=folder)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


@pytest.mark.parametrize("case", ["smooth", "stepped"])
@pytest.mark.parametrize("file", ["m.csv", "m.yaml", "m.json", "m.npz", "m.exact.json"])
def test_no_false_alarm_on_our_own_files(study_command, folder, case, file):
    planned(study_command, folder, case, file)
    ended = study_command("check", file, "--case", f"{case}.yaml", cwd=folder)
    assert ended.returncode == 0, ended.stdout
    assert ended.stdout.rstrip().endswith("feasible")


def test_limits_alone_judge_a_trajectory_with_its_joints_in_any_order(study_command, folder):
    planned(study_command, folder, "smooth", "m.csv")
    head, *rows = (folder / "m.csv").read_text().splitlines()
    order = [0, 2, 1, 4, 3, 6, 5]
    lines = [",".join(line.split(",")[k] for k in order) for line in (head, *rows)]
    (folder / "swapped.csv").write_text("\n".join(lines))
    ended = study_command("check", "swapped.csv", "--limits", "l.yaml", cwd=folder)
    assert ended.returncode == 0, ended.stdout
    assert study_command("check", "swapped.csv", "--case", "smooth.yaml", cwd=folder).returncode == 0


def test_breaches_at_the_samples_and_between_them_are_said_apart(study_command, folder):
    (folder / "fast.csv").write_text("time,a,b\n0,0,0\n0.1,1,0\n0.2,2,0\n")
    ended = study_command("check", "fast.csv", "--limits", "l.yaml", "--interpolation", "linear", cwd=folder)
    assert ended.returncode == 3
    assert "infeasible at the samples: velocity of a reaches 10 of its limit" in ended.stdout
    assert "joined by straight lines" in ended.stdout
    wanting = study_command("check", "fast.csv", "--limits", "l.yaml", "--interpolation", "cubic", cwd=folder)
    assert "has no velocities, which cubic interpolation needs" in wanting.stderr


def test_wishes_about_time(study_command, folder):
    planned(study_command, folder, "smooth", "d.csv", "--duration", "4", "--points", "20")
    slow = read_samples(folder / "d.csv")
    assert slow.times[-1] == pytest.approx(4.0)
    assert len(slow.times) == 20
    planned(study_command, folder, "smooth", "c.csv", "--cycle", "0.008")
    cycles = read_samples(folder / "c.csv")
    assert np.diff(cycles.times) == pytest.approx(0.008)
    planned(study_command, folder, "smooth", "h.csv", "--speed", "0.5")
    planned(study_command, folder, "smooth", "f.csv")
    half, full = read_samples(folder / "h.csv"), read_samples(folder / "f.csv")
    assert half.times[-1] == pytest.approx(2 * full.times[-1], rel=1e-3)
    for samples in (slow, cycles, half, full):
        assert (samples.velocities[[0, -1]] == 0).all()


def test_impossible_wishes_are_refused_before_the_work(study_command, folder):
    for options, sentence in (
        (("--rate", 0), "positive number of samples"),
        (("--points", 1), "at least 2"),
        (("--speed", 2), "at most 1"),
        (("--rate", 100, "--points", 5), "give one of them"),
    ):
        ended = study_command("plan", "smooth.yaml", *options, cwd=folder)
        assert ended.returncode == 2
        assert sentence in ended.stderr


def test_samples_a_few_microseconds_apart_are_no_false_alarm(tmp_path, study_command):
    study_command("init", cwd=tmp_path)
    planned = study_command("plan", "my_case.yaml", "--planner", "free-path", cwd=tmp_path)
    assert planned.returncode == 0, planned.stderr
    for form in ("csv", "yaml", "npz", "exact.json"):
        checked = study_command(
            "check", f"study-output/trajectories/my_case.{form}", "--case", "my_case.yaml", cwd=tmp_path
        )
        assert checked.returncode == 0, checked.stdout


def test_compare_takes_the_same_wishes_and_the_report_finds_them_again(study_command, folder):
    wishes = ("--duration", "4", "--points", "30", "--planners", "ruckig-stops", "--no-report")
    ended = study_command("compare", "smooth.yaml", *wishes, cwd=folder)
    assert ended.returncode == 0, ended.stderr
    samples = read_samples(folder / "study-output/trajectories/smooth.csv")
    assert (samples.times[-1], len(samples.times)) == (pytest.approx(4.0), 30)
    kept = (folder / "study-output/cases/smooth.json").read_text()
    assert '"duration": 4' in kept
    refused = study_command("compare", "--duration", "4", cwd=folder)
    assert refused.returncode == 2
    assert "go with FILE" in refused.stderr


def test_limits_complete_a_case_without_them_and_joints_pick_columns(study_command, folder):
    (folder / "stop.yaml").write_text(
        "units: rad\nwaypoints: [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3]]\nstops: [2]\njoints: [a, b]\n"
    )
    assert study_command("check", "stop.yaml", "--limits", "l.yaml", cwd=folder).returncode == 0
    (folder / "all.csv").write_text("a,b,grip\n0,0,0\n0.5,0.1,0.04\n")
    ended = study_command("check", "all.csv", "--limits", "l.yaml", "--units", "rad", cwd=folder)
    assert "no limits for joint 'grip'" in ended.stderr
    ended = study_command("check", "all.csv", "--limits", "l.yaml", "--units", "rad", "--joints", "b,a", cwd=folder)
    assert ended.returncode == 0, ended.stderr
    assert "not used: column 'grip'" in ended.stdout


@pytest.mark.parametrize(
    ("units", "far", "velocity", "asked"),
    [
        ("rad", 90, 120, ["waypoints of a reach 90 rad; are they meant in deg?", "reach 120 rad/s"]),
        ("deg", 90, 1.5, ["velocity limits of a and b reach 1.5 deg/s; are they meant in rad/s?"]),
        ("[m, mm]", 90, 60, ["waypoints of a reach 90 m; are they meant in mm?", "limits of a reach 60 m/s"]),
        ("deg", 90, 120, []),
        ("rad", 3, 2, []),
    ],
)
def test_odd_magnitudes_are_asked_about_and_never_refused(study_command, folder, units, far, velocity, asked):
    text = f"units: {units}\njoints: [a, b]\nwaypoints: [[0, 0], [{far}, 1]]\nlimits: {{velocity: {velocity}, acceleration: 900}}\n"
    (folder / "odd.yaml").write_text(text)
    ended = study_command("check", "odd.yaml", cwd=folder)
    assert ended.returncode == 0
    assert ended.stdout.count("are they meant in") == len(asked)
    assert all(sentence in ended.stdout for sentence in asked)


def test_joints_without_names_are_said_to_be_unknown_to_a_controller(study_command, folder):
    text = (folder / "smooth.yaml").read_text()
    (folder / "unnamed.yaml").write_text(text.replace("joints: [a, b]\n", ""))
    assert "joint 1 and joint 2 in the files" in planned(study_command, folder, "unnamed", "m.yaml")
    assert "in the files" not in planned(study_command, folder, "unnamed", "m.csv")
    assert "in the files" not in planned(study_command, folder, "smooth", "m.yaml")


def test_a_cycle_gives_equal_steps_to_the_end(study_command, folder):
    planned(study_command, folder, "smooth", "m.csv", "--cycle", 0.01)
    np.testing.assert_allclose(np.diff(read_samples(folder / "m.csv").times), 0.01, rtol=1e-9)
